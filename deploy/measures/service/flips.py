"""Bytes flipped at random in the contents and the database pages of a store, and whether `rigcal fsck` names each of them."""
import json
import subprocess

PAGE_BYTES = 4096
AT_ONCE = 20  # distinct files and pages, so that each has to be named by itself


def flip(path, offset):
    with open(path, "r+b") as file:
        file.seek(offset)
        byte = file.read(1)[0]
        file.seek(offset)
        file.write(bytes([byte ^ 0x10]))


def places(store, chance):
    """(file, offset, the word by which it must be named), half of them contents and half pages, none twice."""
    blobs = [path for path in sorted((store / "blobs").glob("??/*")) if path.stat().st_size > 0 and "." not in path.name]
    database = store / "rigcal.db"
    pages = chance.sample(range(database.stat().st_size // PAGE_BYTES), AT_ONCE // 2)
    for path in chance.sample(blobs, AT_ONCE // 2):
        yield path, chance.randrange(path.stat().st_size), path.name
    for page in pages:
        yield database, page * PAGE_BYTES + chance.randrange(PAGE_BYTES), "page %d of rigcal.db" % (page + 1)


def fsck(context, store):
    done = subprocess.run([str(context.bin / "rigcal"), "fsck", str(store), "--json"], capture_output=True, text=True, timeout=600)
    if done.returncode not in (0, 1):
        raise RuntimeError("fsck: exit %d: %s" % (done.returncode, done.stderr[-300:]))
    return done.returncode, json.loads(done.stdout)


def named(context, store, chance, count):
    """How many of `count` flipped bytes were named; each round mends what it broke, and sees that nothing is damaged then."""
    found = 0
    for _ in range(count // AT_ONCE):
        flipped = list(places(store, chance))
        for path, offset, _word in flipped:
            flip(path, offset)
        code, document = fsck(context, store)
        # "page 1 of" is no part of "page 11 of": names end where a space stands.
        told = " ".join(one["what"] + " " for one in document["findings"] if one["state"] == "damage")
        found += sum(code == 1 and (word + " " in told or word + ")" in told) for _, _, word in flipped)
        for path, offset, _word in flipped:
            flip(path, offset)
    code, document = fsck(context, store)
    if code != 0:
        raise RuntimeError("fsck finds damage where there is none: %r" % document["findings"][:3])
    return found
