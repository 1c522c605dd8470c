#!/usr/bin/env python3
"""Writes what the package is made of, as SPDX 2.3 in JSON: the Debian packages whose libraries its programs load, those
it was built with, and the npm packages inside its pages. Same inputs, same bytes.

usage: sbom.py --version V --epoch SECONDS --packages packages.txt --lock package-lock.json --output FILE PROGRAM...
"""
import argparse
import datetime
import hashlib
import json
import pathlib
import re
import subprocess

NONE = "NOASSERTION"
# Debian's short names of licences that SPDX spells otherwise.
SPELT = {"expat": "MIT", "mit": "MIT", "zlib": "Zlib", "isc": "ISC", "apache-2.0": "Apache-2.0", "apache-2": "Apache-2.0", "bsd-2-clause": "BSD-2-Clause",
         "bsd-3-clause": "BSD-3-Clause", "bsd-3": "BSD-3-Clause", "bsl-1.0": "BSL-1.0", "bsl-1": "BSL-1.0", "mpl-2.0": "MPL-2.0", "mpl2": "MPL-2.0",
         "cc0-1.0": "CC0-1.0", "curl": "curl", "postgresql": "PostgreSQL", "epl-2.0": "EPL-2.0", "epl-2": "EPL-2.0", "mpl-2": "MPL-2.0", "bsd3": "BSD-3-Clause", "bsd-4-clause": "BSD-4-Clause", "x11": "X11", "openldap-2.8": "OLDAP-2.8"}
GNU = re.compile(r"(a?l?gpl)-?v?(\d)(?:\.(\d))?(\+?)$")
# Of packages.txt: what builds and tests, and is not in the programs.
TOOLS = ("build", "packaging", "tests")


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def spdx_licence(name):
    """The SPDX expression of one of Debian's; None where there is no such."""
    words = [word for word in re.split(r"\s+(and|or)\s+", name.strip(), flags=re.IGNORECASE) if word]
    spelt = [word.upper() if word.lower() in ("and", "or") else one_licence(word.strip(" ,()")) for word in words]
    return " ".join(spelt) if spelt and None not in spelt else None


def one_licence(name):
    gnu = GNU.match(name.lower())
    if gnu:
        kind, major, minor, later = gnu.groups()
        return "%s-%s.%s-%s" % (kind.upper(), major, minor or "0", "or-later" if later else "only")
    return SPELT.get(name.lower())


def debian_licence(package):
    """(SPDX or NOASSERTION, Debian's own words) of the paragraph of all files in the package's copyright."""
    file = pathlib.Path("/usr/share/doc", package, "copyright")
    if not file.exists():
        return NONE, ""
    paragraphs = re.split(r"\n\s*\n", file.read_text(errors="replace"))
    for paragraph in paragraphs:
        if re.search(r"^Files:\s*\*\s*$", paragraph, re.MULTILINE):
            found = re.search(r"^License:[ \t]*(.+)$", paragraph, re.MULTILINE)
            if found:
                return spdx_licence(found.group(1)) or NONE, found.group(1).strip()
    return NONE, ""


def needed(program):
    """The names of the libraries that it says itself it needs."""
    return re.findall(r"NEEDED\s+(\S+)", run("objdump", "-p", program))


def loaded(program):
    """{name of library: file}, with those that libraries need."""
    return dict(re.findall(r"^\s*(\S+) => (/\S+)", run("ldd", program), re.MULTILINE))


def owners(files):
    """{file: Debian package}. A merged /usr has each under one of two names."""
    either = {name: file for file in files for name in names_of(file)}
    told = subprocess.run(["dpkg-query", "-S", *sorted(either)], capture_output=True, text=True).stdout  # of unknown names it tells on stderr
    found = {}
    for line in told.splitlines():
        package, _, file = line.partition(": ")
        if file in either:
            found[either[file]] = package.split(":")[0]
    return found


def names_of(file):
    real = str(pathlib.Path(file).resolve())
    return {name for one in (file, real) for name in (one, one.removeprefix("/usr"), "/usr" + one.removeprefix("/usr"))}


def built_with(packages_txt):
    packages, section = [], ""
    for line in packages_txt.read_text().splitlines():
        if line.startswith("#"):
            section = line.lstrip("# ").strip()
        elif line.strip() and section not in TOOLS and line.strip().endswith("-dev"):
            packages.append(line.strip())
    return packages


def debian_part(package, version):
    declared, words = debian_licence(package)
    part = {"name": package, "SPDXID": "SPDXRef-deb-" + re.sub(r"[^A-Za-z0-9.-]", "-", package), "versionInfo": version, "supplier": "Organization: Debian",
            "downloadLocation": NONE, "filesAnalyzed": False, "licenseConcluded": NONE, "licenseDeclared": declared, "copyrightText": NONE,
            "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                              "referenceLocator": "pkg:deb/debian/%s@%s" % (package.replace("+", "%2B"), version.replace("+", "%2B").replace(":", "%3A"))}]}
    if words and declared == NONE:
        part["licenseComments"] = "Debian's copyright file says: " + words
    return part


def npm_part(name, package):
    return {"name": name, "SPDXID": "SPDXRef-npm-" + re.sub(r"[^A-Za-z0-9.-]", "-", name), "versionInfo": package["version"], "downloadLocation": NONE, "filesAnalyzed": False,
            "licenseConcluded": NONE, "licenseDeclared": package.get("license", NONE), "copyrightText": NONE,
            "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                              "referenceLocator": "pkg:npm/%s@%s" % (name.replace("@", "%40"), package["version"])}]}


def npm_packages(lock):
    """[(name, package)] that end in the pages, without what only builds and tests them."""
    packages = json.loads(lock.read_text())["packages"]
    return sorted((path.rpartition("node_modules/")[2], package) for path, package in packages.items() if path and not package.get("dev"))


def versions(packages):
    told = run("dpkg-query", "-W", "-f", "${Package} ${Version}\n", *sorted(packages))
    return dict(line.split(" ", 1) for line in told.splitlines())


def libraries(programs):
    """({package: whether a program itself needs it}, {name of library: package})"""
    files = {}
    for program in programs:
        files.update(loaded(program))
    package_of = owners(set(files.values()))
    missing = sorted(name for name, file in files.items() if file not in package_of)
    if missing:
        raise SystemExit("sbom.py: no Debian package has " + ", ".join(missing))
    itself = {name for program in programs for name in needed(program)}
    of_library = {name: package_of[file] for name, file in files.items()}
    return {package: any(of_library[name] == package for name in itself & set(of_library)) for package in of_library.values()}, of_library


def document(version, epoch, packages_txt, lock, programs):
    linked, of_library = libraries(programs)
    built = built_with(packages_txt)
    version_of = versions(set(linked) | set(built))
    rigcal = {"name": "rigcal", "SPDXID": "SPDXRef-rigcal", "versionInfo": version, "downloadLocation": NONE, "filesAnalyzed": False, "licenseConcluded": "Apache-2.0",
              "licenseDeclared": "Apache-2.0", "copyrightText": "2026 The Rigcal authors", "primaryPackagePurpose": "APPLICATION"}
    parts, relations = [rigcal], [("SPDXRef-DOCUMENT", "DESCRIBES", "SPDXRef-rigcal")]
    for package in sorted(set(linked) | set(built)):
        part = debian_part(package, version_of[package])
        names = sorted(name for name, owner in of_library.items() if owner == package)
        if names:
            part["comment"] = "libraries: " + ", ".join(names)
        parts.append(part)
        if package in linked:
            relations.append(("SPDXRef-rigcal", "DYNAMIC_LINK" if linked[package] else "DEPENDS_ON", part["SPDXID"]))
        if package in built:
            relations.append((part["SPDXID"], "BUILD_DEPENDENCY_OF", "SPDXRef-rigcal"))
    for name, package in npm_packages(lock):
        parts.append(npm_part(name, package))
        relations.append(("SPDXRef-rigcal", "CONTAINS", parts[-1]["SPDXID"]))
    digest = hashlib.sha256(json.dumps([parts, relations]).encode()).hexdigest()
    created = datetime.datetime.fromtimestamp(epoch, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": "rigcal-" + version,
            "documentNamespace": "https://rigcal.invalid/spdx/rigcal-%s-%s" % (version, digest), "creationInfo": {"created": created, "creators": ["Organization: Rigcal", "Tool: sbom.py"]},
            "packages": parts, "relationships": [{"spdxElementId": a, "relationshipType": kind, "relatedSpdxElement": b} for a, kind, b in relations]}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--version", required=True)
    parser.add_argument("--epoch", type=int, required=True)
    parser.add_argument("--packages", type=pathlib.Path, required=True)
    parser.add_argument("--lock", type=pathlib.Path, required=True)
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("programs", nargs="+")
    given = parser.parse_args()
    made = document(given.version, given.epoch, given.packages, given.lock, given.programs)
    given.output.write_text(json.dumps(made, indent=1) + "\n")


if __name__ == "__main__":
    main()
