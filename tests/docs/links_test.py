#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that the documents name what exists: relative links with their anchors, files and folders in backticks, documents
named in comments of the code, and the table of installed headers."""
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("core", "graph", "sketch", "mcmc", "dytex", "pipeline", "apps", "tests", "docs", "scripts", "cmake")
errors = []


def without_code(text):
    return re.sub(r"```.*?```", "", text, flags=re.S)


def anchors(path):
    """Anchors of a page's headings, as GitHub makes them."""
    found = set()
    for heading in re.findall(r"^#+ (.*)$", without_code(path.read_text()), flags=re.M):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").lower()
        found.add(re.sub(r"[^\w\- ]", "", words).strip().replace(" ", "-"))
    return found


def check_links(page, text):
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        there = (page.parent / path).resolve() if path else page
        if not there.exists():
            errors.append(f"{page.relative_to(ROOT)}: link to {target}, which is not there")
        elif anchor and there.suffix == ".md" and anchor not in anchors(there):
            errors.append(f"{page.relative_to(ROOT)}: link to {target}, a heading that is not there")


def check_paths(page, text):
    for quoted in re.findall(r"`([^`\n]+)`", text):
        for path in quoted.split():
            path = path.rstrip(",;:")
            if not path.startswith(tuple(room + "/" for room in ROOMS)) or re.search(r"[*<>{}$…]|NAME|ROOM", path):
                continue
            if not (ROOT / path).exists():
                errors.append(f"{page.relative_to(ROOT)}: `{path}` is not there")


def check_comments():
    """Documents that sources, scripts and build files speak of."""
    for room in ROOMS:
        for path in (ROOT / room).rglob("*"):
            if path.suffix in (".hpp", ".cpp", ".py", ".cmake", ".txt", ".js") and path.is_file():
                for document in re.findall(r"\bdocs/[\w/]+\.md\b", path.read_text(errors="replace")):
                    if not (ROOT / document).exists():
                        errors.append(f"{path.relative_to(ROOT)}: {document} is not there")


def check_figures():
    for figure in (ROOT / "docs/method/figures").iterdir():
        if figure.stat().st_size > 120_000:
            errors.append(f"{figure.relative_to(ROOT)}: more than 120 kB")
        if not any(figure.name in page.read_text() for page in (ROOT / "docs/method").glob("*.md")):
            errors.append(f"{figure.relative_to(ROOT)}: no chapter shows it")


def main():
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    for page in pages:
        text = without_code(page.read_text())
        check_links(page, text)
        check_paths(page, text)
    check_comments()
    check_figures()
    headers = subprocess.run([ROOT / "scripts/api-docs", "--check-headers"], capture_output=True, text=True)
    if headers.returncode:
        errors.append(headers.stderr.strip())
    for error in errors:
        print(error, file=sys.stderr)
    print(f"{len(pages)} pages checked, {len(errors)} errors")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
