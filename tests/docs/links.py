#!/usr/bin/python3
"""Checks every relative link and #anchor of README.md and docs/**/*.md, and that no z* is taken for emphasis: links.py ROOT."""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1]).resolve()
pages = [root / "README.md", *sorted((root / "docs").rglob("*.md"))]


def without_code(text):
    text = re.sub(r"<!--.*?-->", "", text, flags=re.S)
    text = re.sub(r"^( *)(```+).*?^ *\2 *$", "", text, flags=re.S | re.M)
    text = "\n".join("" if re.match(r"(    |\t)", line) and not re.match(r"\s+([-*]|\d+\.) ", line) else line
                     for line in text.splitlines())
    return re.sub(r"(`+).+?\1", lambda code: "`" * len(code[0]), text)


def anchors(page):
    """As GitHub makes them of headings; a second one of the same name gets -1."""
    text = re.sub(r"^( *)(```+).*?^ *\2 *$", "", page.read_text(), flags=re.S | re.M)
    found = set(re.findall(r'(?:id|name)="([^"]+)"', text))
    for heading in re.findall(r"^#{1,6} +(.+?) *#*$", text, re.M):
        heading = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower()
        name = once = re.sub(r"[^\w\- ]", "", heading).replace(" ", "-")
        for count in range(1, 100):
            if name not in found:
                break
            name = f"{once}-{count}"
        found.add(name)
    return found


broken, links = [], 0
for page in pages:
    text = without_code(page.read_text())
    for star in re.findall(r"[^\n]*\b[xz]\*[^\n]*", text):
        broken.append(f"{page.relative_to(root)}: write z\\* where a star is meant, or it sets what follows in italics: {star}")
    targets = re.findall(r"!?\[[^]]*\]\(([^)\s]+)[^)]*\)", text) + re.findall(r"^\[[^]]+\]: (\S+)", text, re.M)
    for target in targets:
        if re.match(r"[a-z]+:", target):
            continue
        links += 1
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        where = f"{page.relative_to(root)}: {target}: "
        if not file.exists():
            broken.append(where + "there is no such file")
        elif not file.is_relative_to(root):
            broken.append(where + "outside of the project")
        elif anchor and (file.suffix != ".md" or anchor not in anchors(file)):
            broken.append(where + f"no heading '{anchor}' there")

nav = re.findall(r": (\S+\.md)$", (root / "docs/mkdocs.yml").read_text(), re.M)
listed = {root / "docs" / name for name in nav}
for name in nav:
    if name not in ("index.md", "api.md") and not (root / "docs" / name).exists():
        broken.append(f"docs/mkdocs.yml: {name}: there is no such file")
for page in pages[1:]:
    if page not in listed:
        broken.append(f"docs/mkdocs.yml: {page.relative_to(root / 'docs')} is not listed")
print("\n".join(broken) or f"{links} links in {len(pages)} pages hold")
sys.exit(bool(broken))
