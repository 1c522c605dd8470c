"""What C++ text declares: its classes with what they hold, and its public prototypes with or without a contract.

Reads code in the style of this project, without a compiler: macros are not expanded, and names are not looked up."""
import bisect
import re

import sources

SCOPE = re.compile(r"\b(namespace|class|struct|union|enum)\b")
ACCESS = re.compile(r"\b(public|protected|private)\s*$")
NOT_DECLARED = re.compile(r"^(using|typedef|friend|static_assert|extern\s+template|namespace|enum|(class|struct|union)\s+[\w:]+$)\b|^$")
OPERATOR = re.compile(r"\boperator\s*(\(\s*\)|\[\s*\]|[^\s\w(]+|\"\"\s*\w+|(?=\w))")
CLOSING = {"(": ")", "[": "]", "{": "}"}


class Class:
    def __init__(self, name, line):
        self.name, self.line, self.methods, self.members = name, line, [], []


class Prototype:
    """`grouped`: a contract stands above it, or above the prototypes that it follows without a blank line; `covered`: so it
    does, or on its own line."""
    def __init__(self, name, first, last, grouped, beside):
        self.name, self.first, self.last, self.grouped, self.covered = name, first, last, grouped, grouped or beside


def matching(code, start):
    """Where the bracket that opens at `start` closes."""
    depth, opening = 0, code[start]
    for at in range(start, len(code)):
        depth += (code[at] == opening) - (code[at] == CLOSING[opening])
        if depth == 0:
            return at
    return len(code) - 1


def without_brackets(text, pattern, by=""):
    while True:
        shorter = re.sub(pattern, by, text)
        if shorter == text:
            return text
        text = shorter


def declared(text):
    """One declaration without attributes, template arguments, values in braces, and with `()` for every list of parameters."""
    text = re.sub(r"\[\[[^\]]*\]\]|\balignas\s*\([^)]*\)", " ", text)
    text = OPERATOR.sub("operator_ ", text).replace("->", " ")
    text = without_brackets(text, r"\{[^{}]*\}")
    text = without_brackets(text, r"\([^()]*\)", "\0")
    text = without_brackets(text, r"<[^<>]*>").replace("\0", "()")
    text = re.sub(r"\b(template|explicit\s*\(\)|explicit|inline|virtual|constexpr|mutable|decltype\s*\(\)|noexcept\s*\(\))(?=\W|$)", " ", text)
    return " ".join(text.split())


def is_function(text):
    return "()" in text.split("=")[0]


def function_name(text):
    return re.search(r"(~?\w*)\s*\(\)", text).group(1)


def member_names(text):
    """Of `double a = 0, b` both; nothing of what is static."""
    if re.search(r"\bstatic\b", text):
        return []
    names = [re.split(r"=|(?<!:):(?!:)", part)[0].split() for part in text.split(",")]
    return [words[-1].lstrip("*&") for words in names if words]


class Outline:
    def __init__(self, text):
        code = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", sources.blank, sources.code_of(text), flags=re.MULTILINE)
        self.code, self.starts = code, [0] + [at + 1 for at, c in enumerate(text) if c == "\n"]
        self.classes, self.prototypes = [], []
        self.above, self.beside = comment_lines(text)
        self.scope(0, len(code), None, True)

    def line(self, at):
        return bisect.bisect_right(self.starts, at)

    def scope(self, start, end, owner, public):
        """Reads what stands between two braces; `owner`: the class; `public`: who includes the file can name it."""
        siblings, begin, at, shown = [], start, start, public
        while at < end:
            c = self.code[at]
            if c in "([":
                at = matching(self.code, at)
            elif c == ":" and self.code[at + 1] != ":" and (label := ACCESS.search(self.code[begin:at])):
                shown, begin = public and label.group(1) == "public", at + 1
            elif c == ";":
                self.declaration(begin, at, at, owner, shown, siblings)
                begin = at + 1
            elif c == "{":
                at, begin = self.braces(begin, at, owner, shown, siblings)
                at = max(at, begin - 1)
            at += 1

    def braces(self, begin, opening, owner, shown, siblings):
        """Where a pair of braces ends, and where the next declaration begins."""
        head, closing = self.code[begin:opening], matching(self.code, opening)
        bare = declared(head)
        kind = SCOPE.search(bare)
        if kind and not is_function(bare) or re.fullmatch(r"extern", bare):
            self.inner(kind.group(1) if kind else "namespace", bare, begin, opening, closing, shown)
            after = closing + 1 if not kind or kind.group(1) == "namespace" else self.code.index(";", closing) + 1
            return closing, after
        rest = self.code[closing + 1:closing + 200].lstrip()[:1]
        if not is_function(bare) or rest in (",", "{", ";", ")"):  # a value in braces
            return closing, begin
        self.declaration(begin, opening, closing, owner, shown, siblings)
        return closing, closing + 1

    def inner(self, kind, bare, begin, opening, closing, shown):
        if kind == "namespace":
            hidden = re.search(r"namespace$|\b(detail|internal)\b", bare)
            self.scope(opening + 1, closing, None, shown and not hidden)
        elif kind in ("class", "struct"):
            name = re.search(r"\b(?:class|struct)\s+([\w:]+)", bare)
            found = Class(name.group(1) if name else "", self.line(opening))
            self.classes.append(found)
            body = opening + 1
            if kind == "class":  # private until it says otherwise
                label = re.compile(r"\b(public|protected|private)\s*:(?!:)").search(self.code, body, closing)
                body_end = label.start() if label else closing
                self.scope(body, body_end, found, False)
                body = body_end
            self.scope(body, closing, found, shown)

    def declaration(self, begin, end, last, owner, shown, siblings):
        text = declared(self.code[begin:end])
        if NOT_DECLARED.search(text):
            return
        function = is_function(text)
        if owner is not None:
            self.member(text, function, owner)
        if function and shown:
            self.prototype(text, begin, end, last, owner, siblings)

    def member(self, text, function, owner):
        if function and not re.search(r"=\s*(default|delete)$", text):
            owner.methods.append(function_name(text))
        elif not function:
            owner.members += member_names(text)

    def prototype(self, text, begin, end, last, owner, siblings):
        name = function_name(text)
        if re.search(r"=\s*(default|delete)$|\b(override|final)\b", text) or name.startswith("~") or "::" in text.split("()")[0].split()[-1]:
            return
        first, head_last = self.line(begin + len(self.code[begin:end]) - len(self.code[begin:end].lstrip())), self.line(end)
        last = self.line(last)
        grouped = first - 1 in self.above or any(one.last == first - 1 and one.grouped for one in siblings[-1:])
        told_until = last if last <= first + 1 else head_last  # a comment within a longer body is none for the caller
        beside = any(number in self.beside for number in range(first, told_until + 1))
        found = Prototype((owner.name + "::" if owner else "") + name, first, last, grouped, beside)
        siblings.append(found)
        self.prototypes.append(found)


def comment_lines(text):
    """Lines that are a comment and nothing else, and lines with code and a comment. A comment beside code that goes on
    below it, in the same column, belongs to the second."""
    above, beside, column = set(), set(), {}
    code = sources.code_of(text).split("\n")
    for number, (line, bare) in enumerate(zip(text.split("\n"), code), 1):
        stripped = line.strip()
        at = comment_column(line)
        if at is None:
            continue
        if stripped.startswith(("//", "/*")) and not bare.strip():
            if column.get(number - 1) == at:
                column[number] = at
            else:
                above.add(number)
        else:
            beside.add(number)
            column[number] = at
    return above, beside


def comment_column(line):
    for match in sources.LITERAL.finditer(line):
        if match.group(0).startswith(("//", "/*")):
            return match.start()
    return None
