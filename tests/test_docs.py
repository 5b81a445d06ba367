"""The site: it builds without a warning, is complete, opens offline, and its links lead somewhere."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from collections import Counter
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest

from eccentric.cli import COMMANDS
from eccentric.effects import FAMILIES, Setting, library
from eccentric.model import load_model
from eccentric.rigs import read_rig
from eccentric.signals import read_channels

# The site takes most of a minute to build.
pytestmark = pytest.mark.slow
ROOT = Path(__file__).resolve().parents[1]
GREEK = {
    "eta": "η",
    "mu": "μ",
    "rho": "ρ",
    "tau": "τ",
    "alpha": "α",
    "theta": "θ",
    "sigma": "σ",
    "kappa": "κ",
}
FETCHED = {"src", "srcset", "data", "poster", "action", "background"}
"""Attributes whose address a browser fetches by itself, besides those of <link>."""


class Page(HTMLParser):
    """Addresses that a page links to and fetches, its anchors and its pictures."""

    def __init__(self, text: str) -> None:
        """Read the page."""
        super().__init__()
        self.links: list[str] = []
        self.fetched: list[str] = []
        self.pictures: list[dict[str, str | None]] = []
        self.anchors: set[str | None] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Sort the addresses of a tag."""
        values = dict(attrs)
        self.anchors.add(values.get("id"))
        if tag == "img":
            self.pictures.append(values)
        for name, value in values.items():
            if name in FETCHED or (tag == "link" and name == "href"):
                self.fetched.append(value or "")
            elif name in {"href", "xlink:href"}:
                self.links.append(value or "")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the site as `make docs` does: a warning is an error."""
    for name in ("sphinx", "furo", "myst_parser"):
        if importlib.util.find_spec(name) is None:
            pytest.skip(f"{name} is not installed (extra `docs`)")
    out = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "sphinx",
            "-qEW",
            "--keep-going",
            "-d",
            out / ".doctrees",
            "docs",
            out / "html",
        ],
        cwd=ROOT,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (0, "")
    return out / "html"


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, Page]:
    """Every page by its path, read."""
    found = {path: Page(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}
    assert {"index", "tutorial", "commands", "rig", "diagnosis"} < {path.stem for path in found}
    return found


SOURCES = "benchmarks|derivations|docs|eccentric|examples|generated|templates|tests"
DOCS = sorted(path.name for path in (ROOT / "docs").glob("*.md"))
PAGES = ["README.md", "CONTRIBUTING.md", *(f"docs/{name}" for name in DOCS)]


@pytest.mark.parametrize("page", PAGES)
def test_the_paths_that_a_page_names_exist(page: str) -> None:
    """Every folder and file of the clone that a page names is there."""
    text = (ROOT / page).read_text(encoding="utf-8")
    paths = re.findall(rf"`((?:{SOURCES})/[\w./-]*)`", text)

    assert [] == [path for path in paths if not (ROOT / path).exists()]
    # The page that says where things are names some: the pattern finds them.
    assert page != "CONTRIBUTING.md" or len(paths) > 30


def test_contributors_learn_where_a_change_goes() -> None:
    """A format, the verdict, C, the words of an effect: each line names the file that has it."""
    rows = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").split("| you are looking for |")[1]
    place = dict(row.strip("| ").split(" | ", 1) for row in rows.splitlines() if row.startswith("| "))
    expected = {
        "where a new log format goes": ("FORMATS", "eccentric/logs/formats.py"),
        "where the verdict is decided": ("def decided", "eccentric/diagnosis/search/verdict.py"),
        "where C is printed": ("BACKEND = Backend(", "eccentric/emission/backends/c99/__init__.py"),
        "where a new back end goes": ("TARGETS", "eccentric/core/targets.py"),
        "an effect: its equation and its description": ("Words(", "eccentric/effects/stribeck.py"),
        "where a new family of effects goes": ("FAMILIES", "eccentric/effects/__init__.py"),
    }

    assert expected.keys() <= place.keys()
    for what, (has, path) in expected.items():
        assert path.removesuffix("/__init__.py") in place[what]
        assert has in (ROOT / path).read_text(encoding="utf-8")


def test_every_family_has_its_section_and_its_pictures(pages: dict[Path, Page]) -> None:
    """One section for each family of the library, in it a picture for white pages and one for dark ones."""
    sections = Counter(
        anchor
        for path, page in pages.items()
        if path.parent.name == "effects"
        for anchor in page.anchors & set(FAMILIES)
    )
    assert Counter(list(FAMILIES)) == sections
    for family in FAMILIES:
        texts = [p.read_text(encoding="utf-8") for p in pages if p.parent.name == "effects"]
        (text,) = [text for text in texts if f'id="{family}"' in text]
        section = re.split(r"<h2", text.split(f'id="{family}"', 1)[1], maxsplit=2)[1]
        styles = Counter(
            re.findall(r'<img class="only-(light|dark)" src="../_images/effects/[^"]+"', section)
        )
        assert styles["light"] == styles["dark"] > 0, family
        assert "<math" in section, family


def test_pictures_are_there_and_told_in_words(pages: dict[Path, Page]) -> None:
    """Every picture exists, holds a curve, and has a text for those who do not see it."""
    for path, page in pages.items():
        for picture in page.pictures:
            assert picture.get("alt"), (path.name, picture)
            file = path.parent / unquote(str(picture["src"]))
            assert file.is_file(), (path.name, picture["src"])
            if file.suffix == ".svg":
                assert "line2d" in file.read_text(encoding="utf-8"), file.name


def typeset(formula: str) -> str:
    """The letters and signs that a page shows of a typed formula, without spaces."""
    for name, letter in GREEK.items():
        formula = re.sub(rf"\b{name}(?=_|\b)", letter, formula)
    formula = re.sub(r"\b1 (?=θ)", "", formula)  # a factor of 1 before an angle is not written
    formula = re.sub(r"\bw(?=_|\b)", "ω", formula).replace("sqrt", "√").replace("-", "−")
    return re.sub(r"[\s_^]", "", re.sub(r"\^\(([^)]*)\)", r"\1", formula))


def test_formulas_stand_whole_in_their_tables(site: Path) -> None:
    """The table of families holds every letter and sign of each formula: a bar in it is no border."""
    page = (site / "effects" / "index.html").read_text(encoding="utf-8")
    rows = [unescape(re.sub(r"<[^>]+>|\s", "", row)) for row in re.findall(r"<tr.*?</tr>", page, re.DOTALL)]
    logged = {"temperature_mid": 25.0, "channels": frozenset({"current", "voltage", "temperature"})}
    setting = Setting(load_model("c2_parallel"), 0.2, {}, 1.0, 60.0, 15.0, 60.0, 70.0, **logged)
    firsts = {effect.family: effect.formula for effect in reversed(library(setting))}
    assert len(firsts) > 30
    for family, formula in firsts.items():
        (row,) = [row for row in rows if f"{family}{typeset(formula)}" in row.replace("-", "−")]
        assert row


def test_the_tested_versions_are_the_pinned_ones() -> None:
    """The packages in the table of the first page have the versions of constraints.txt."""
    page = (
        (ROOT / "docs" / "index.md").read_text(encoding="utf-8").split("## Tested versions")[1].split("##")[0]
    )
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pins = dict(line.split("==") for line in lines if "==" in line)
    shown = dict(re.findall(r"([\w-]+) (\d+\.\d+\.\d+)\b", page))

    assert {name: pins.get(name) for name in shown} == shown
    assert len(shown) > 5


def test_every_command_is_told(site: Path) -> None:
    """The help of each command is on the page of the command line."""
    text = (site / "commands.html").read_text(encoding="utf-8")
    for command in COMMANDS:
        assert f"usage: eccentric {command}" in text


def test_nothing_is_fetched_from_outside(site: Path, pages: dict[Path, Page]) -> None:
    """What a browser fetches by itself lies in the site: in pages, style sheets and pictures."""
    fetched = [address for page in pages.values() for address in page.fetched]
    assert fetched
    assert [address for address in fetched if re.match(r"(\w+:)?//", address)] == []
    for sheet in (*site.rglob("*.css"), *site.rglob("*.svg")):
        text = sheet.read_text(encoding="utf-8")
        assert re.findall(r"""(?:url\(|@import|src=|<image[^>]+href=)\s*["']?(?:\w+:)?//""", text) == [], (
            sheet
        )


def test_links_lead_somewhere(pages: dict[Path, Page]) -> None:
    """Links within the site name a file that is there, and an anchor that is in it."""
    checked = 0
    for path, page in pages.items():
        for address in (*page.links, *page.fetched):
            if re.match(r"\w+:", address) or address in {"", "#"}:
                continue
            place, _, anchor = address.partition("#")
            target = (path.parent / unquote(place.split("?")[0])).resolve() if place else path
            assert target.is_file(), (path.name, address)
            if anchor and target.suffix == ".html":
                known = pages[target].anchors if target in pages else set()
                assert unquote(anchor) in known, (path.name, address)
            checked += 1
    assert checked > 100


def test_the_site_holds_no_path_of_this_computer(site: Path) -> None:
    """No text of the site names the folder it was built in or from."""
    for path in site.rglob("*"):
        if path.suffix in {".html", ".js", ".svg", ".css", ".txt"} or path.name == ".buildinfo":
            text = path.read_text(encoding="utf-8")
            for place in (ROOT, site, Path.home() if Path.home() != Path("/") else ROOT):
                assert f"{place}/" not in text, path.name


def test_the_first_page_shows_the_errors_of_least_squares_by_hand(site: Path) -> None:
    """Its picture has those of the paper's columns alone before, and with the planted harmonic after."""
    rig = read_rig(ROOT / "examples" / "bench" / "bench.toml")
    c, k = read_channels([ROOT / "examples" / "bench" / "bench.csv.gz"], rig), rig.known
    link, sign = k["mu"] * c.motion.theta_m, np.sign(c.motion.omega_m)
    pull, weight = k["M"] * k["L"] * (k["mu"] * c.motion.omega_m) ** 2, (k["M"] + k["M_l"]) * 9.81
    normal = np.hypot(pull * np.sin(link), pull * np.cos(link) + weight)
    assert c.motor.current is not None
    inertia = k["J_m"] + k["mu"] ** 2 * k["J_l"]
    gravity = k["mu"] * k["M"] * 9.81 * k["L"] * np.sin(link)
    target = k["k_i"] * c.motor.current - inertia * c.motion.alpha_m - gravity
    paper = [sign, c.motion.omega_m, normal * sign, normal * c.motion.omega_m]
    shown, expected = c.selection.score_rows & (c.motion.omega_m > 0.0), []
    for columns in (paper, [*paper, np.cos(2.0 * link) * sign, np.sin(2.0 * link) * sign]):
        design = np.column_stack(columns)
        found = np.linalg.lstsq(design[c.selection.fit_rows], target[c.selection.fit_rows], rcond=None)[0]
        expected.append(f"{1e3 * np.sqrt(np.mean((target - design @ found)[shown] ** 2)):.0f}")
    picture = (site / "_images" / "bench.svg").read_text(encoding="utf-8")

    assert expected == re.findall(r": (\d+) mN m rms", picture)
