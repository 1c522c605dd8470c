"""Who includes whom, by the table of docs/includes.md: cycles, and includes against the order of its rows."""
import include_table_test as table


def includes(texts):
    """Of each file the files of `texts` that it includes."""
    return {path: {name for angled, name in table.includes_of(text) if not angled and name in texts} for path, text in texts.items()}


def between(arrows, name_of):
    """The same arrows between groups of files, without those within a group."""
    grouped = {}
    for source, targets in arrows.items():
        grouped.setdefault(name_of(source), set()).update(name_of(target) for target in targets)
    return {group: targets - {group} for group, targets in grouped.items()}


def reached(arrows, start):
    seen, waiting = set(), [start]
    while waiting:
        for target in arrows.get(waiting.pop(), ()):
            if target not in seen:
                seen.add(target)
                waiting.append(target)
    return seen


def cycles(arrows):
    """Sorted groups of nodes that reach each other and themselves."""
    reach = {node: reached(arrows, node) for node in arrows}
    on_cycle = [node for node in arrows if node in reach[node]]
    return sorted({tuple(sorted(other for other in on_cycle if other in reach[node] and node in reach[other])) for node in on_cycle})


def upward(texts, rows):
    """Includes that the table does not allow, and those of a module of a later row than the file's own."""
    order = {module: number for number, module in enumerate(rows)}
    found = table.problems(texts, rows)
    for path, targets in includes(texts).items():
        own, highest = table.module_of(path, rows), max(order.values())
        if own is not None and rows[own].allowed is not None:
            later = sorted(target for target in targets if order.get(table.module_of(target, rows), highest) > order[own])
            found += ["%s: %s is of a later row" % (path, target) for target in later]
    return found
