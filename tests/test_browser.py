"""report.html in a real browser: quiet, offline, drawn, readable on a phone, in the dark and on paper."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from reported import HOSTILE, nothing_missing, sample

from eccentric.diagnosis import Diagnosis
from eccentric.presentation.html import page, report

playwright = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")

ROOT = Path(__file__).resolve().parent.parent
LOG, RIG = ROOT / "examples" / "bench" / "bench.csv.gz", ROOT / "examples" / "bench" / "bench.json"
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
FLAGS = (
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
)  # fmt: skip
# `make test` reads the page; what a browser makes of it takes a minute.
pytestmark = pytest.mark.slow
DRAWN = "html[data-figures=drawn]"
# The plots whose canvases all have one colour: what is under a plot's element is in shadow trees.
BLANK = """() => {
  const canvases = (node) => [...node.querySelectorAll("*")].flatMap((one) =>
    one.tagName === "CANVAS" ? [one] : one.shadowRoot ? canvases(one.shadowRoot) : []);
  const varied = (canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const pixels = new Uint32Array(data.buffer);
    return pixels.some((pixel) => pixel !== pixels[0]);
  };
  const blank = (plot) => !canvases(plot).some(varied);
  return [...document.querySelectorAll(".plot")].filter(blank).map((plot) => plot.id);
}"""
TEXT_COLOURS = """() => [...new Set(Bokeh.documents.flatMap((d) => d.roots()).flatMap((root) =>
  [...root.references()].filter((m) => m.type === "LinearAxis").map((m) => m.axis_label_text_color)))]"""
FIRST_LEGEND = """() => {
  const [root] = Bokeh.documents[0].roots();
  const legend = root.above.find((model) => model.type === "Legend");
  const box = Bokeh.index.get_by_id(root.id).views.get_one(legend).el.getBoundingClientRect();
  return [box.x, box.y, box.height];
}"""
FIRST_CURVE = """() => Bokeh.documents[0].roots()[0].above.find((model) => model.type === "Legend")
  .items[0].renderers.map((renderer) => renderer.visible)"""
LABEL_KINDS = """() => Bokeh.documents[0].roots().flatMap((root) =>
  [...root.references()].filter((m) => m.type === "LinearAxis").map((m) => m.axis_label.type))"""
# Pixels of the first plot in the colour of the fitted effect, #009e73.
EFFECT_PIXELS = """() => {
  const canvases = (node) => [...node.querySelectorAll("*")].flatMap((one) =>
    one.tagName === "CANVAS" ? [one] : one.shadowRoot ? canvases(one.shadowRoot) : []);
  return canvases(document.querySelector(".plot")).map((canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return new Uint32Array(data.buffer).filter((pixel) => pixel === 0xff739e00).length;
  }).reduce((all, one) => Math.max(all, one), 0);
}"""
# How many pictures for the printer have letters in the ink of the light page, #1b1e23, opaque.
DARK_LETTERS = """() => [...document.querySelectorAll(".printed")].filter((canvas) => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return new Uint32Array(data.buffer).includes(0xff231e1b);
}).length"""
WIDEST = (
    "Math.max(...[...document.querySelectorAll('.plot > *')].map((p) => p.getBoundingClientRect().width))"
)

SCROLLS_UPRIGHT = """() => [...document.querySelectorAll("main *")].filter((box) =>
  box.scrollHeight > box.clientHeight && ["auto", "scroll"].includes(getComputedStyle(box).overflowY))
  .map((box) => box.className)"""
# Of neighbouring labels on the axes below, from the widths that a canvas measures.
LEAST_GAP = """() => Math.min(...Bokeh.documents[0].roots().flatMap((root) => {
  const view = Bokeh.index.get_by_id(root.id);
  const axis = view.views.get_one(root.below[0]);
  const pen = document.createElement("canvas").getContext("2d");
  pen.font = "12px system-ui, sans-serif";
  const [ticks] = axis.tick_coords.major;
  const labels = axis.compute_labels(ticks).items.map((label, k) => {
    const half = pen.measureText(label.text).width / 2;
    const at = view.frame.x_scale.compute(ticks[k]);
    return [at - half, at + half];
  }).sort((a, b) => a[0] - b[0]);
  return labels.slice(1).map(([start], k) => start - labels[k][1]);
}))"""

Opened = Callable[..., Any]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Headless Chromium as the system has it."""
    path = next(filter(None, map(shutil.which, NAMES)), None)
    if path is None:
        pytest.skip("no Chromium is installed (on Debian: apt-get install chromium)")
    with playwright.sync_playwright() as started:
        chromium = started.chromium.launch(executable_path=path, args=list(FLAGS))
        yield chromium
        chromium.close()


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory, bundled: tuple[Diagnosis, Path]) -> Path:
    """Reports on disk: of the bundled log, of made-up ones, and of one whose names are attacks."""
    out = tmp_path_factory.mktemp("reports")
    texts = {
        "bundled": report(bundled[0]),
        "long": page(sample(100_000, 4)),
        "short": page(nothing_missing(sample(50))),
        "hostile": page(sample(text=HOSTILE)),
    }
    for name, text in texts.items():
        (out / f"{name}.html").write_text(text, encoding="utf-8")
    return out


@pytest.fixture
def opened(browser: Any, pages: Path) -> Iterator[Opened]:
    """Open a report by name; a page that says, throws or fetches anything fails the test at its end."""
    heard: list[str] = []
    contexts = []

    def open_page(name: str, **options: Any) -> Any:
        context = browser.new_context(**{"viewport": {"width": 1200, "height": 900}} | options)
        contexts.append(context)
        one = context.new_page()
        one.on("pageerror", lambda error: heard.append(f"error: {error}"))
        one.on("dialog", lambda dialog: heard.append(f"dialog: {dialog.message}"))
        one.on("console", lambda m: m.type == "error" and heard.append(f"{m.type}: {m.text}"))
        one.on("request", lambda r: r.url.startswith(("file:", "data:", "blob:")) or heard.append(r.url))
        one.goto((pages / f"{name}.html").as_uri())
        one.wait_for_selector(DRAWN, timeout=30_000)
        one.wait_for_function("() => document.querySelectorAll('.plot').length > 0")
        return one

    yield open_page
    for context in contexts:
        context.close()
    assert [] == heard


def all_drawn(one: Any) -> None:
    """Wait until no plot is blank."""
    one.wait_for_function(f"() => ({BLANK})().length === 0", timeout=20_000)


@pytest.mark.parametrize(("name", "plots"), [("bundled", 12), ("long", 8), ("short", 8), ("hostile", 8)])
def test_every_figure_is_drawn(opened: Opened, pages: Path, name: str, plots: int) -> None:
    """Each plot has a canvas with something on it; nothing is fetched, nothing complains; below 5 MB."""
    one = opened(name)
    all_drawn(one)

    assert plots == one.locator(".plot").count()
    assert (pages / f"{name}.html").stat().st_size < 5e6


def test_names_that_are_attacks_are_text(opened: Opened) -> None:
    """No element and no dialog comes from a hostile name, also when figures show their hover texts."""
    one = opened("hostile")
    all_drawn(one)
    for plot in one.locator(".plot").all():
        plot.hover()

    assert 0 == one.locator("img").count()
    assert 3 == one.locator("script").count()
    assert HOSTILE in (one.locator("main").text_content() or "")
    # A string between dollar signs would be TeX, for which Bokeh would fetch a typesetter.
    assert ["PlainText"] * 16 == one.evaluate(LABEL_KINDS)


def test_the_pointer_shows_values_and_leaves_the_curves(opened: Opened) -> None:
    """Over the middle of the first plot: channel, curves with their unit, rows; no curve is taken away."""
    one = opened("long")
    all_drawn(one)
    first = one.locator(".plot").first
    first.scroll_into_view_if_needed()
    before = one.evaluate(EFFECT_PIXELS)
    first.hover()
    said = one.locator(".bk-tooltip-content").inner_text()

    assert before > 100
    assert before == one.evaluate(EFFECT_PIXELS)
    assert all(name in said for name in ("at:", "paper's model:", "fitted effect:", " N m", "rows:")), said


def test_a_box_that_is_drawn_is_zoomed_into(opened: Opened) -> None:
    """Three tenths of the width of the first plot then take all of it."""
    one = opened("long")
    all_drawn(one)
    first = one.locator(".plot").first
    first.scroll_into_view_if_needed()
    box = first.bounding_box()
    ends = "[Bokeh.documents[0].roots()[0].x_range].map((range) => range.end - range.start)[0]"
    whole = one.evaluate(ends)
    x, y, width = box["x"], box["y"], box["width"]
    one.mouse.move(x + 0.3 * width, y + 80)
    one.mouse.down()
    one.mouse.move(x + 0.6 * width, y + 160, steps=5)
    one.mouse.up()
    one.wait_for_function(f"() => {ends} < {whole}")

    assert 0.3 * whole == pytest.approx(one.evaluate(ends), rel=0.3)


@pytest.mark.parametrize("zoom", [0.9, 1.0, 1.1])
def test_equations_and_tables_scroll_sideways_only(opened: Opened, zoom: float) -> None:
    """At no zoom does a box whose content is a pixel too high for it get an upright scrollbar."""
    one = opened("bundled")
    one.evaluate(f"document.body.style.zoom = {zoom}")

    assert [] == one.evaluate(SCROLLS_UPRIGHT)


def test_labels_of_a_phone_do_not_touch(opened: Opened) -> None:
    """At 360 pixels there is a gap between labels, also those of 0.018 N m either way, after a resize too."""
    one = opened("short", viewport={"width": 1200, "height": 740})
    all_drawn(one)
    one.evaluate("Bokeh.documents[0].roots()[0].x_range.setv({ start: -0.018, end: 0.018 })")
    one.set_viewport_size({"width": 360, "height": 740})
    one.wait_for_function(f"() => {WIDEST} < 360")

    assert one.evaluate(LEAST_GAP) > 0.0


@pytest.mark.parametrize("name", ["bundled", "hostile"])
def test_a_phone_scrolls_in_one_direction(opened: Opened, name: str) -> None:
    """At 360 pixels nothing is wider than the screen; what is wide scrolls in its own box."""
    one = opened(name, viewport={"width": 360, "height": 740}, is_mobile=True, has_touch=True)
    all_drawn(one)

    assert 360 == one.evaluate("document.documentElement.scrollWidth")
    assert one.evaluate(WIDEST) < 360


def test_the_dark_scheme_turns_page_and_figures(opened: Opened) -> None:
    """A change of the scheme changes the background, the text of the page and that of every figure."""
    one = opened("short", color_scheme="light")
    background = "getComputedStyle(document.body).backgroundColor"
    light = one.evaluate(background), one.evaluate(TEXT_COLOURS)
    one.emulate_media(color_scheme="dark")
    one.wait_for_selector("html[data-scheme=dark]")
    dark = one.evaluate(background), one.evaluate(TEXT_COLOURS)

    assert ("rgb(255, 255, 255)", ["#1b1e23"]) == light
    assert ("rgb(21, 24, 28)", ["#e7e9ec"]) == dark


def test_a_click_on_the_legend_hides_a_curve(opened: Opened) -> None:
    """The first entry of the first legend turns its curve off, and on again."""
    one = opened("long")
    all_drawn(one)
    one.locator(".plot").first.scroll_into_view_if_needed()
    x, y, height = one.evaluate(FIRST_LEGEND)
    seen = []
    for _ in range(2):
        one.mouse.click(x + 20, y + height / 2)
        seen.append(one.evaluate(FIRST_CURVE))

    assert [[False] * 3, [True] * 3] == seen


def test_paper_is_white_and_has_every_figure(opened: Opened) -> None:
    """A page that is dark on the screen prints pictures with dark letters, no wider than the paper."""
    one = opened("short", color_scheme="dark")
    all_drawn(one)
    one.emulate_media(media="print")
    one.set_viewport_size({"width": 690, "height": 900})
    one.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert "rgb(27, 30, 35)" == one.evaluate("getComputedStyle(document.body).color")
    boxes = [picture.bounding_box() for picture in one.locator(".printed").all()]

    assert 8 == one.evaluate(DARK_LETTERS)
    assert [True] * 8 == [box["width"] > 300 and box["x"] + box["width"] <= 690 for box in boxes]
    assert 0 == one.locator(".plot > :not(.printed):visible").count()
    one.emulate_media(media="screen")
    one.evaluate("dispatchEvent(new Event('afterprint'))")
    assert 8 == one.locator(".plot > :not(.printed):visible").count()
    assert ["#e7e9ec"] == one.evaluate(TEXT_COLOURS)


def test_a_blank_plot_is_noticed(opened: Opened) -> None:
    """The check that every figure is drawn fails where a canvas is empty."""
    one = opened("short")
    all_drawn(one)
    one.evaluate("document.querySelector('.plot').replaceChildren(document.createElement('canvas'))")

    assert ["plot-1"] == one.evaluate(BLANK)
