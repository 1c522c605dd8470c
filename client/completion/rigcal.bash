# Completion of rigcal for bash, as `rigcal completion bash` prints it.
_rigcal() {
  local program=${1/#\~\//$HOME/} typed=${COMP_WORDS[COMP_CWORD]} line
  COMPREPLY=()
  [ "$typed" != "=" ] || typed="" # bash takes --robot=mapper-01 apart
  while IFS= read -r line; do
    case $line in
      :files) compopt -o default ;;
      :folders) compopt -o dirnames ;;
      "$typed"*) COMPREPLY+=("${line%%$'\t'*}") ;;
    esac
  done < <("$program" complete-words -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
}
complete -F _rigcal rigcal
