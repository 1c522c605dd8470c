"""Stretches of C++ that are the same but for the names in them."""
import collections
import re

import sources

TOKEN = re.compile(r"[A-Za-z_]\w*|\d[\w.']*|::|->|<<|>>|&&|\|\||[-+*/=!<>]=|\S")
KEYWORDS = set("auto bool break case catch char class const constexpr continue default delete do double else enum explicit false float "
               "for friend if inline int long namespace new nullptr operator private public return short sizeof static struct switch "
               "template this throw true try typename unsigned using virtual void while".split())


def tokens(text):
    """(token, line) of what a compiler reads, without directives and literals' contents; numbers are one token, "0"."""
    code = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", sources.blank, sources.code_of(text), flags=re.MULTILINE)
    found = []
    for number, line in enumerate(code.split("\n"), 1):
        found += [("0" if token[0].isdigit() else token, number) for token in TOKEN.findall(line)]
    return found


def is_name(token):
    return (token[0].isalpha() or token[0] == "_") and token not in KEYWORDS


def renamed(window):
    """The window with its names replaced by the order in which they first appear."""
    order = {}
    return tuple(order.setdefault(token, len(order)) if is_name(token) else token for token in window)


def candidates(shapes, length):
    """Groups of places where so many tokens have one shape, all names taken as one."""
    places = collections.defaultdict(list)
    for file, shape in enumerate(shapes):
        for at in range(len(shape) - length + 1):
            places[hash(tuple(shape[at:at + length]))].append((file, at))
    return [group for group in places.values() if len(group) > 1]


def same_windows(texts, length):
    """Places of equal windows in pairs: ((file, at), (file, at)), none overlapping its partner."""
    files = [[token for token, _ in text] for text in texts]
    numbers = {}
    shapes = [[numbers.setdefault("name" if is_name(token) else token, len(numbers)) for token in file] for file in files]
    for group in candidates(shapes, length):
        equal = collections.defaultdict(list)
        for file, at in group:
            equal[renamed(files[file][at:at + length])].append((file, at))
        for places in equal.values():
            for i, (file, at) in enumerate(places):
                yield from (((file, at), other) for other in places[i + 1:] if other[0] != file or other[1] >= at + length)


def same_stretches(texts, length=60):
    """Pairs ((file, line), (file, line)) of the longest stretches of at least `length` tokens that are the same but for
    names, each told once, in order. `texts`: of each file what `tokens` gives."""
    windows = set(same_windows(texts, length))
    starts = [((f, a), (g, b)) for (f, a), (g, b) in windows if ((f, a - 1), (g, b - 1)) not in windows]
    return sorted(((f, texts[f][a][1]), (g, texts[g][b][1])) for (f, a), (g, b) in starts)
