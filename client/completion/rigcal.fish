# Completion of rigcal for fish, as `rigcal completion fish` prints it.
function __rigcal_words
    set -l typed (commandline -ct)
    set -l words (commandline -opc)
    set -e words[1]
    for line in (command rigcal complete-words -- $words "$typed" 2>/dev/null)
        switch $line
            case ':files'
                __fish_complete_path "$typed"
            case ':folders'
                __fish_complete_directories "$typed"
            case '*'
                printf '%s\n' $line
        end
    end
end
complete -c rigcal -f -a '(__rigcal_words)'
