#!/usr/bin/env python3
"""One script that makes an empty store as all files of storage/schema do one after the other, each of which would read the whole schema again at
every table that it renames: newest_schema.py OUTPUT FILE... (the oldest first)."""
import sqlite3
import sys

KINDS = ("table", "index", "view", "trigger")  # none of one before those that it needs


def literal(value):
    if isinstance(value, str):
        return "'%s'" % value.replace("'", "''")
    if value is None or isinstance(value, int):
        return "NULL" if value is None else str(value)
    raise TypeError("a row of a new store has %r" % (value,))


def main():
    output, *files = sys.argv[1:]
    database = sqlite3.connect(":memory:")
    for path in files:
        with open(path, encoding="utf-8") as file:
            database.executescript(file.read())
    made = database.execute("SELECT type, name, sql FROM sqlite_master WHERE sql IS NOT NULL AND name NOT LIKE 'sqlite_%' ORDER BY rowid").fetchall()
    statements = {kind: [sql for type_, _, sql in made if type_ == kind] for kind in KINDS}
    for type_, name, _ in made:
        if type_ == "table":
            statements["index"] += ["INSERT INTO %s VALUES (%s)" % (name, ", ".join(map(literal, row)))
                                    for row in database.execute("SELECT * FROM %s" % name)]
    with open(output, "w", encoding="utf-8") as file:
        for kind in KINDS:
            file.writelines(sql + ";\n" for sql in statements[kind])


main()
