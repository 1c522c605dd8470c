"""What a technician is to be told of a robot, and whether it was."""
import dataclasses
import re
import typing

EXIT_CODES = {"pass": 0, "fail": 1, "warn": 5, "unknown": 6}
DRIVE = {"pass": r"OK to drive until \d{1,2} [A-Z][a-z]{2}", "warn": r"OK to drive; \S.* by \d{1,2} [A-Z][a-z]{2}", "fail": r"Do not drive",
         "unknown": r"Not verified: do not rely on \S"}
NEVER = "(?!)"  # matches nothing
DRIVE_WORDS = ("OK to drive until", "OK to drive;", "Do not drive", "Not verified")
ACCUSES = (r"moved|bump|exchange|swap|bent|bend|disagree|contradict|wrong|fail|two poses|missing|could not|cannot|nominal|"
           r"not (known|measured|calibrated)")
EXCUSES = r"unseen|unnoticed|not (have been|be) noticed|^so "  # what follows from a fault of something else is told, not blamed


@dataclasses.dataclass
class Wanted:
    """`states`: of pass warn fail unknown refused, one, or those among which the data do not decide, as a|b. `why`: of the first sentence.
    `of`: sensors and boards that may be blamed. `never`: what no sentence may say."""
    states: str
    why: str
    action: str
    of: typing.Tuple[str, ...] = ()
    never: str = NEVER
    drive: str = ""  # if it is not that of the state
    refused_code: int = 4
    in_text: bool = False  # said by `show` before the verdict, as it changes without a revision


@dataclasses.dataclass
class Told:
    state: str
    why: str
    action: str
    text: str = ""
    codes: typing.Dict[str, int] = dataclasses.field(default_factory=dict)


def sentences(text):
    return [one for one in re.split(r"(?<=[.!?:;])\s+", text.strip()) if one]


def says(pattern, text):
    return re.search(pattern, text, re.IGNORECASE) is not None


def named(names, sentence):
    return [name for name in names if says(r"(?<![\w.-])%s(?![\w-])" % re.escape(name), sentence)]


def accused(told, wanted, names):
    """Those who are blamed and are not to be: in a sentence of their own, or as what may be meant instead."""
    others, found = [name for name in names if name not in wanted.of], []
    for sentence in sentences(told.why + " " + told.action):
        right = named(wanted.of, sentence)
        instead = any(says(r"\b(%s) or (%s)\b" % pair, sentence) for name in others for one in right for pair in ((name, one), (one, name)))
        if instead or (not right and says(ACCUSES, sentence) and not says(EXCUSES, sentence)):
            found += named(others, sentence)
    return sorted(set(found))


def drive_fault(told, wanted):
    if told.state == "refused":
        return []
    said = [words for words in DRIVE_WORDS if words in told.text]
    right = len(said) == 1 and re.search(wanted.drive or DRIVE.get(told.state, NEVER), told.text)
    return [] if right else ["drive: %s" % (" and ".join(said) or "no line")]


def code_faults(told, wanted):
    code = wanted.refused_code if told.state == "refused" else EXIT_CODES.get(told.state, EXIT_CODES["unknown"])
    return ["%s ends with %d" % (verb, told.codes[verb]) for verb in told.codes if told.codes[verb] != code]


def faults(told, wanted, names):
    """One short text per thing that was to be said otherwise."""
    found = [] if told.state in wanted.states.split("|") else ["state: " + told.state]
    first = next(iter(re.split(r"(?<=[.!?])\s+", told.why.strip())), "")
    if not says(wanted.why, first):
        found.append("why: " + first)
    if not says(wanted.action, told.action):
        found.append("action: " + told.action)
    if says(wanted.never, told.why + " " + told.action):
        found.append("never: " + re.search(wanted.never, told.why + " " + told.action, re.IGNORECASE).group(0))
    blamed = accused(told, wanted, names)
    return found + (["accused: " + " ".join(blamed)] if blamed else []) + code_faults(told, wanted) + drive_fault(told, wanted)
