#!/usr/bin/python3
"""The built site opens offline: site.py SITE. No file loads anything from a host, and every link between pages holds."""
import html.parser
import pathlib
import re
import sys
import urllib.parse

site = pathlib.Path(sys.argv[1]).resolve()
faults = []


class Page(html.parser.HTMLParser):
    def __init__(self, file):
        super().__init__()
        self.names, self.links, self.loads = set(), [], []
        self.feed(file.read_text(errors="replace"))

    def handle_starttag(self, tag, attributes):
        has = dict(attributes)
        self.names |= {has[key] for key in ("id", "name") if has.get(key)}
        if tag == "a" and has.get("href"):
            self.links.append(has["href"])
        elif tag == "link" and has.get("rel") not in ("canonical", "next", "prev", "edit"):
            self.loads.append(has.get("href") or "")
        self.loads += [has[key] for key in ("src", "data", "poster") if has.get(key)]


pages = {file: Page(file) for file in site.rglob("*.html") if file.name != "404.html"}
api = site / "api"
for file, page in pages.items():
    where = file.relative_to(site)
    for target in page.loads:
        if re.match(r"(https?:)?//", target):
            faults.append(f"{where} loads {target}")
    for target in page.links + page.loads:
        parts = urllib.parse.urlsplit(target)
        if parts.scheme or target.startswith("//") or "javascript" in target:
            continue
        there = (file.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else file
        if not there.exists():
            faults.append(f"{where}: {target}: there is no such file")
        elif parts.fragment and there in pages and not there.is_relative_to(api):
            if urllib.parse.unquote(parts.fragment) not in pages[there].names | {"__skip", "__toc"}:
                faults.append(f"{where}: {target}: no such place there")
for file in site.rglob("*.css"):
    for target in re.findall(r"(?:url\(|@import) *[\"']?((?:https?:)?//[^\"')]+)", file.read_text(errors="replace")):
        faults.append(f"{file.relative_to(site)} loads {target}")
if not (api / "index.html").exists():
    faults.append("there is no API reference")
print("\n".join(sorted(set(faults))) or f"{len(pages)} pages open offline")
sys.exit(bool(faults))
