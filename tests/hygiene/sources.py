"""The project's own text files, and C++ text with its comments and literals blanked out."""
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
NOT_OURS = {".git", "build", "node_modules", "__pycache__"}
LITERAL = re.compile(
    r"""//(?:[^\n\\]|\\.)*            # line comment
      | /\*.*?\*/                     # block comment
      | R"(?P<tag>[^\s()\\]{0,16})\(.*?\)(?P=tag)"   # raw string
      | "(?:[^"\\\n]|\\.)*"           # string
      | (?<![0-9a-fA-F])'(?:[^'\\\n]|\\.)*'          # character, not the separator of 1'000
    """,
    re.DOTALL | re.VERBOSE,
)


def tracked():
    """Paths of all text files, relative to the root, sorted; what git ignores is left out."""
    listing = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, text=True, check=False)
    if listing.returncode == 0:
        names = listing.stdout.splitlines()
    else:
        names = [str(path.relative_to(ROOT)) for path in ROOT.rglob("*")]
    paths = sorted({pathlib.PurePosixPath(name) for name in names})
    return [path for path in paths if not NOT_OURS & set(path.parts) and is_text(ROOT / path)]


def is_text(path):
    if not path.is_file() or path.is_symlink():
        return False
    with path.open("rb") as file:
        return b"\0" not in file.read(4096)


def read(path):
    return (ROOT / path).read_text(encoding="utf-8", errors="replace")


def blank(match):
    return re.sub(r"[^\n]", " ", match.group(0))


def code_of(text):
    """C++ without comments, strings and characters; every line keeps its number and length."""
    return LITERAL.sub(blank, text)
