"""The disk as a power loss leaves it: what was synced, and of the rest what chance has let through.

The pessimistic reading of POSIX, which ext4 and xfs meet: fsync of a file makes its bytes and its size durable, not its name;
fsync of a folder makes the names in it durable, not the folder's own; a rename is there whole or not at all, and neither
without a sync of the folder; everything else may be dropped, torn, or come in another order (Pillai et al., "All file
systems are not created equal", OSDI 2014; Mohan et al., "Finding crash-consistency bugs with bounded black-box crash
testing", OSDI 2018).
"""
import dataclasses
import os
import pathlib

from disk_record import CREATE, LINK, MAKE_FOLDER, REMOVE, RENAME, SYNC, SYNC_DISK, TRUNCATE, WRITE

SECTOR_BYTES, PAGE_BYTES = 512, 4096


class Node:
    """A file or a folder: what is durable of it, and what was done to it since."""

    def __init__(self, is_folder=False):
        self.is_folder = is_folder
        self.durable = {} if is_folder else b""
        self.pending = []  # of a file: (offset, bytes), bytes None: its size from then on
        self.now = {}      # of a folder: the names as programs see them

    def content(self):
        return written(self.durable, self.pending)


def written(before, steps):
    content = bytearray(before)
    for offset, data in steps:
        end = offset + (len(data) if data is not None else 0)
        if data is None:
            del content[offset:]
        if len(content) < (end if data is not None else offset):
            content.extend(bytes((end if data is not None else offset) - len(content)))
        if data is not None:
            content[offset:end] = data
    return bytes(content)


@dataclasses.dataclass
class Change:
    """Of names, as one step: (folder, name, node or None). A rename has two."""
    parts: list


class Disk:
    def __init__(self):
        self.root = Node(is_folder=True)
        self.nodes = {}    # inode number -> the node that has it now
        self.changes = []  # of names, in their order, as far as they are not durable

    def folder_of(self, path):
        node = self.root
        for name in path.split("/")[:-1]:
            node = node.now[name]
        return node, path.split("/")[-1]

    def node_at(self, path):
        folder, name = self.folder_of(path)
        return folder.now.get(name)

    def change(self, *parts):
        for folder, name, node in parts:
            folder.now[name] = node
            if node is None:
                del folder.now[name]
        self.changes.append(Change(list(parts)))

    def apply(self, record, ignored=False):
        """`ignored`: a sync that does nothing, as if the program did not ask for it."""
        if record.act in (CREATE, MAKE_FOLDER):
            node = self.nodes[record.inode] = Node(record.act == MAKE_FOLDER)
            if record.path:
                self.change((*self.folder_of(record.path), node))
        elif record.act == WRITE:
            self.nodes[record.inode].pending.append((record.offset, record.data))
        elif record.act == TRUNCATE:
            self.nodes[record.inode].pending.append((record.offset, None))
        elif record.act == RENAME:
            self.rename(record.path, record.other)
        elif record.act == LINK:
            self.change((*self.folder_of(record.path), self.nodes[record.inode]))
        elif record.act == REMOVE:
            self.change((*self.folder_of(record.path), None))
        elif record.act == SYNC and not ignored:
            self.sync(self.nodes.get(record.inode, self.root))
        elif record.act == SYNC_DISK and not ignored:
            self.sync_all()

    def rename(self, source, target):
        node = self.node_at(source)
        if node is not self.node_at(target):  # two names of one file stay
            self.change((*self.folder_of(target), node), (*self.folder_of(source), None))

    def sync(self, node):
        if not node.is_folder:
            node.durable, node.pending = node.content(), []
            return
        left = []
        for change in self.changes:
            # A name that a rename took from here is there already where it went.
            touched = [part for part in change.parts if part[0] is node]
            settled = change.parts if any(part[2] is None for part in touched) else touched
            for folder, name, target in settled:
                set_name(folder.durable, name, target)
                for earlier in left if folder is not node else ():
                    earlier.parts = [part for part in earlier.parts if part[0] is not folder or part[1] != name]
            change.parts = [part for part in change.parts if not any(part is one for one in settled)]
            left.append(change)
        self.changes = [change for change in left if change.parts]

    def sync_all(self):
        for change in self.changes:
            for folder, name, node in change.parts:
                set_name(folder.durable, name, node)
        self.changes = []
        for node in self.nodes.values():
            if not node.is_folder:
                node.durable, node.pending = node.content(), []

    def after_power_loss(self, fate):
        """Names and contents as they are found then: {path: bytes, or None of a folder}."""
        kept = {}  # folder -> names
        for change in fate.changes(self.changes):
            for folder, name, node in change.parts:
                set_name(kept.setdefault(id(folder), dict(folder.durable)), name, node)
        found = {}

        def walk(folder, above):
            for name, node in kept.get(id(folder), folder.durable).items():
                path = above + name
                if node.is_folder:
                    found[path] = None
                    walk(node, path + "/")
                else:
                    found[path] = fate.content(node)
        walk(self.root, "")
        return found


def set_name(names, name, node):
    if node is None:
        names.pop(name, None)
    else:
        names[name] = node


class Nothing:
    """Whatever was not synced is gone."""
    @staticmethod
    def changes(_pending):
        return []

    @staticmethod
    def content(node):
        return node.durable


class Everything:
    """Nothing is gone: the process was killed."""
    @staticmethod
    def changes(pending):
        return pending

    @staticmethod
    def content(node):
        return node.content()


class Chance:
    """Of names: none, all, all up to one, or any; of contents likewise, and torn, or only their size; by a seed."""

    def __init__(self, chance):
        self.chance = chance
        self.names = chance.choice(["none", "all", "first", "any"])
        self.bytes = chance.choice(["none", "all", "first", "any", "torn", "size", "mixed"])
        self.contents = {}

    def changes(self, pending):
        if self.names == "first":
            return pending[:self.chance.randrange(len(pending) + 1)]
        if self.names == "any":
            return [one for one in pending if self.chance.random() < 0.5]
        return pending if self.names == "all" else []

    def content(self, node):
        if id(node) not in self.contents:  # one file may have two names
            self.contents[id(node)] = self.chosen(node)
        return self.contents[id(node)]

    def chosen(self, node):
        how = self.bytes if self.bytes != "mixed" else self.chance.choice(["none", "all", "first", "any", "torn", "size"])
        if how == "none" or not node.pending:
            return node.durable
        if how == "first":
            return written(node.durable, node.pending[:self.chance.randrange(len(node.pending) + 1)])
        if how == "size":
            return written(node.durable, [(offset, data and bytes(len(data))) for offset, data in node.pending])
        if how == "all":
            return node.content()
        return written(node.durable, [piece for step in node.pending for piece in self.pieces(step, how)])

    def pieces(self, step, how):
        offset, data = step
        if data is None:
            return [step] if self.chance.random() < 0.5 else []
        size = SECTOR_BYTES if how == "torn" else PAGE_BYTES
        return [(offset + at, data[at:at + size]) for at in range(0, len(data), size) if self.chance.random() < 0.5]


def write_down(found, folder):
    """Makes the folder anew."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True)
    for path, content in found.items():
        if content is None:
            os.mkdir(folder / path)
        else:
            (folder / path).write_bytes(content)
