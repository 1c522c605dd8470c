#!/usr/bin/env python3
"""Writes the man page of a program of ours from what it says with --help, one section per verb.

usage: manpage.py PROGRAM SECTION VERSION OUTPUT.gz      same help, same bytes: no date, no machine
"""
import gzip
import os
import re
import subprocess
import sys

# What CLI11 writes behind an option's name: type, range, default, environment.
RANGE = re.compile(r":?(?:INT|FLOAT|UINT) in \[(\S+) - (\S+)\]")
DEFAULT = re.compile(r"^(\S+(?: \S+)?)=(\S+)$")
FROM_ENVIRONMENT = re.compile(r"\s*\(Env:(\w+)\)")
COLUMN = 30  # where CLI11 begins the meaning; a longer name has it on the next line
EXAMPLE = re.compile(r"^  \S")


def help_of(program, *verb):
    environment = {name: value for name, value in os.environ.items() if not name.startswith("RIGCAL_")}
    environment.update(HOME="~", LC_ALL="C.UTF-8")
    return subprocess.run([program, *verb, "--help"], env=environment, capture_output=True, text=True, check=True).stdout


def parts_of(text):
    """Description, usage, [(group, [(term, meaning)])], the lines of the footer."""
    lines = text.rstrip().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("Usage: "))
    description, usage = " ".join(lines[:start]).strip(), lines[start][len("Usage: "):]
    groups, at = [], start + 1
    while at < len(lines):
        if not lines[at]:
            at += 1
        elif re.fullmatch(r"(Options|Positionals|Subcommands|\[.*\]):", lines[at]):
            title = lines[at].rstrip(":")
            entries, at = entries_from(lines, at + 1)
            groups.append((title, entries))
        else:
            break
    return description, usage, groups, lines[at:]


def entries_from(lines, at):
    entries = []
    while at < len(lines) and lines[at].startswith("  "):
        line, at = lines[at], at + 1
        is_long = at < len(lines) and lines[at].startswith(" " * COLUMN)
        if line.startswith(" " * COLUMN):
            entries[-1][1] = (entries[-1][1] + " " + line.strip()).strip()
        else:
            entries.append([line.strip(), ""] if is_long else [line[:COLUMN].strip(), line[COLUMN:].strip()])
    return [tidied(*entry) for entry in entries], at


def tidied(term, meaning):
    """'--threads INT:INT in [1 - 64]=2' as '--threads N' with range and default in words."""
    notes = []
    bounds = RANGE.search(term)
    if bounds:
        notes.append("%s to %s" % bounds.groups())
        term = RANGE.sub("", term)
    environment = FROM_ENVIRONMENT.search(term)
    if environment:
        notes.append("or the environment variable " + environment.group(1))
        term = FROM_ENVIRONMENT.sub("", term)
    default = DEFAULT.match(term) if "NAME=VALUE" not in term else None
    if default:
        notes.append("default " + default.group(2))
        term = default.group(1)
    term = re.sub(r"\bINT\b|\bFLOAT\b", "N", term.replace(",", ", ", 1) if term.startswith("-h") else term)
    return term, meaning + ("; " + ", ".join(notes) if notes else "")


def escaped(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("~", "\\(ti").replace("'", "\\(aq").replace("`", "\\(ga")
    return "\\&" + text if text[:1] in (".", "'") else text


def body(description, groups, footer):
    roff = [".PP", escaped(description + ("" if description.endswith(".") else "."))] if description else []
    for _, entries in groups:
        for term, meaning in entries:
            roff += [".TP", "\\fB%s\\fR" % escaped(term), escaped(meaning)]
    return roff + prose(footer)


def prose(lines):
    """Indented lines keep their shape, the rest flows."""
    roff, in_example = [], False
    for line in lines:
        is_example = bool(EXAMPLE.match(line))
        if is_example != in_example:
            roff += [".PP", ".RS 4", ".nf"] if is_example else [".fi", ".RE"]
        if not is_example and line:
            roff.append(".PP")
        if line:
            roff.append(escaped(line.strip() if is_example else line))
        in_example = is_example
    return roff + ([".fi", ".RE"] if in_example else [])


def verb_section(program, name):
    description, usage, groups, footer = parts_of(help_of(program, name))
    groups = [(title, [entry for entry in entries if not entry[0].startswith("-h")]) for title, entries in groups]
    return [".SS %s" % escaped(name), "\\fB%s\\fR" % escaped(usage)] + body(description, groups, footer)


def page(program, section, version):
    name = os.path.basename(program)
    description, usage, groups, footer = parts_of(help_of(program))
    verbs = [term for title, entries in groups if title == "Subcommands" for term, _ in entries]
    summary = re.split(r"[:.]", description)[0]
    roff = ['.TH %s %s "" "rigcal %s" "Rigcal"' % (name.upper(), section, version),
            ".SH NAME", "%s \\- %s" % (escaped(name), escaped(summary[0].lower() + summary[1:])),
            ".SH SYNOPSIS", "\\fB%s\\fR" % escaped(usage), ".SH DESCRIPTION", escaped(description), ".SH OPTIONS"]
    roff += body("", [group for group in groups if group[0] != "Subcommands"], [])
    if verbs:
        roff.append(".SH VERBS")
        for verb in verbs:
            roff += verb_section(program, verb)
    roff.append(".SH NOTES" if footer[0].startswith("Exit") else ".SH EXAMPLES")
    roff += prose(footer[1:] if footer[0] == "Examples:" else footer)
    other = "rigcal(1)" if name == "rigcald" else "rigcald(8)"
    roff += [".SH SEE ALSO", "%s, and the files below /usr/share/doc/rigcal." % other]
    return "\n".join(roff) + "\n"


def main():
    program, section, version, output = sys.argv[1:]
    with open(output, "wb") as file, gzip.GzipFile("", "wb", 9, file, mtime=0) as packed:
        packed.write(page(program, section, version).encode())


if __name__ == "__main__":
    main()
