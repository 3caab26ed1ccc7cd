"""The manual: what it links to is there, what is generated is current, and no method is left out."""

import re
from itertools import pairwise

import pytest
from catoptric.addon.methods.registry import METHODS
from catoptric.batch.cli import main
from catoptric.docs import write_parameters
from PIL import Image

from .test_house import ROOT

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
LINK = re.compile(r"\]\(([^)\s]+)\)")
PICTURES = ("*.png", "*.jpg")
LARGEST_BYTES, WIDEST = 200_000, 1200


def targets(page):
    """Where a page's links and pictures lead, but for other sites."""
    return [link for link in LINK.findall(page.read_text(encoding="utf-8")) if not re.match(r"\w+:", link)]


def anchors(page):
    """The places of a page that a link may name, as web sites of Git make them of headings."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading).strip().lower().replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_leads_somewhere(page):
    lost = []
    for target in targets(page):
        path, _, place = target.partition("#")
        there = (page.parent / path) if path else page
        if not there.exists() or (place and place not in anchors(there)):
            lost.append(target)
    assert lost == []


def test_every_page_is_among_the_contents():
    contents = ROOT / "docs" / "README.md"
    assert {page.name for page in PAGES[1:]} - {contents.name} <= set(targets(contents))


def test_every_picture_is_shown_and_small():
    shown = {(page.parent / target).resolve() for page in PAGES for target in targets(page)}
    pictures = {path for pattern in PICTURES for path in (ROOT / "docs").rglob(pattern)}
    assert pictures - shown == set()
    for path in sorted((ROOT / "docs" / "pictures").iterdir()):
        assert path.stat().st_size <= LARGEST_BYTES, path.name
        assert Image.open(path).width <= WIDEST, path.name


def test_the_page_of_parameters_is_what_the_methods_declare():
    written = write_parameters.PAGE.read_text(encoding="utf-8")
    assert written == write_parameters.page(), "run python -m catoptric.docs.write_parameters"


def test_page_and_command_name_every_parameter(capsys):
    main(["methods"])
    printed = " ".join(capsys.readouterr().out.split())
    sections = dict(re.findall(r"^## (\S+)$\n(.*?)(?=^## |\Z)", write_parameters.page(), re.DOTALL | re.MULTILINE))
    for name, method in METHODS.items():
        assert method.source in sections[name]
        assert re.findall(r"^\| `(\w+)`", sections[name], re.MULTILINE) == [one.name for one in method.parameters]
        for parameter in method.parameters:
            assert parameter.help in sections[name]
            assert f"{name}.{parameter.name} = " in printed


def test_every_method_has_a_paragraph_on_when_to_choose_it():
    lines = (ROOT / "docs" / "choosing-a-method.md").read_text(encoding="utf-8").splitlines()
    headings = [number for number, line in enumerate(lines) if line.startswith("#")] + [len(lines)]
    said = {lines[start]: " ".join(lines[start + 1 : end]).split() for start, end in pairwise(headings)}
    for name in METHODS:
        (words,) = (words for heading, words in said.items() if f"`{name}`" in heading)
        assert len(words) > 30, name
