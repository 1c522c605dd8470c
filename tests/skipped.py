"""Prints a regular expression for ctest that matches the tests that a run skipped; nothing where it skipped none.

skipped.py JUNIT   (as `ctest --output-junit` writes it)
"""
import re
import sys
import xml.etree.ElementTree

cases = xml.etree.ElementTree.parse(sys.argv[1]).iter("testcase")
names = [re.sub(r"[^A-Za-z0-9_]", ".", case.get("name")) for case in cases if case.find("skipped") is not None]
if names:
    print("^(" + "|".join(names) + ")$")
