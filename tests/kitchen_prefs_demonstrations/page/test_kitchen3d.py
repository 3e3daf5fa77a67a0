"""What a visitor sees and chooses in the kitchen in three dimensions: Debian's chromium."""

import base64
import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import sync_playwright

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.rendering.tableware import colour
from kitchen_prefs.simulation import kitchen as k
from kitchen_prefs.simulation.layout import RACK_TRAVEL, SINK_POSITION
from kitchen_prefs.simulation.sessions import make_session
from kitchen_prefs.web.kitchen_data import layout_data, session_data
from kitchen_prefs.web.page import SHARED, joined, self_contained_page
from kitchen_prefs_demonstrations.page.building import THREE, THREE_SCRIPTS
from kitchen_prefs_demonstrations.page.kitchen_gltf import kitchen_glb

CHROMIUM = Path("/usr/bin/chromium")
PATIENCE = 120_000  # milliseconds; the machine may be busy
SCREEN = {"width": 440, "height": 340}
SESSION = make_session("seen", 5)  # nine dishes at the start, two cups among them
PRESENT = [CATEGORIES[index] for index in SESSION.dishes.category[: SESSION.dishes.present]]
FIRST_OF = {category: PRESENT.index(category) for category in sorted(set(PRESENT))}
CUP, BIG_PLATE = k.FIRST_DISH, k.FIRST_DISH + 1
RED, GREEN = 0, 1
IN_THE_TOP = [k.DOOR, k.TOP_RACK]
TEMPLATE = """<!doctype html><html lang="en"><head><title>Kitchen</title>
<meta http-equiv="Content-Security-Policy" content="$policy"><style>$style</style></head>
<body><div id="kitchen"></div><p id="said"></p>
<script type="application/json" id="data">$data</script><script>$script</script></body></html>"""
EXAMPLE = Path(__file__).with_name("kitchen3d_example.js")

pytestmark = [
    pytest.mark.xdist_group("kitchen3d"),
    pytest.mark.browser,
    pytest.mark.slow,
    pytest.mark.skipif(not CHROMIUM.exists(), reason="needs Debian's chromium"),
]


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A page with the view; at the end the console is empty and nothing was fetched."""
    file = tmp_path_factory.mktemp("page") / "kitchen.html"
    data = {
        "layout": layout_data(),
        "session": session_data(SESSION),
        "glb": base64.b64encode(kitchen_glb()).decode(),
    }
    scripts = [THREE / name for name in THREE_SCRIPTS]
    script = joined(SHARED / "basics.js", SHARED / "kitchen.js", *scripts, EXAMPLE)
    style = joined(SHARED / "house.css", THREE / "kitchen3d.css")
    file.write_text(self_contained_page(TEMPLATE, style, script, data))
    with sync_playwright() as driver:
        browser = driver.chromium.launch(
            executable_path=str(CHROMIUM),
            args=["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
            timeout=PATIENCE,
        )
        page = browser.new_page(viewport=SCREEN, reduced_motion="reduce")
        page.set_default_timeout(PATIENCE)
        messages, requests = [], []
        page.on("console", lambda message: messages.append(message.text))
        page.on("pageerror", lambda error: messages.append(str(error)))
        page.on("request", lambda request: requests.append(request.url))
        page.goto(file.as_uri())
        page.evaluate("view.ready")
        yield page
        browser.close()
    assert messages == []
    assert requests == [file.as_uri()]


@pytest.fixture
def begin(page):
    """Starts the session anew, after some decisions."""
    return lambda decisions: page.evaluate("begin", decisions)


def where(page, thing, *point):
    """Where a thing of the view is on the screen, by its middle or by another point of it."""
    return page.evaluate(f"onScreen({thing}, ...{list(point or (0, 0, 0))})")


def placement_on_screen(page, instance):
    """Where the middle of a dish at a placement of the top rack would be on the screen."""
    position = f"...view.model.placements[{instance - k.FIRST_PLACEMENT['top']}].position"
    return page.evaluate(f"onScreen(view.model.racks[state.out], {position})")


def free_of(page):
    return page.evaluate("view.placements.filter((one) => !one.blocked).map((one) => one.instance)")


def picture(page):
    """What is on the screen, (H, W, 3) uint8."""
    page.evaluate("drawn()")
    return np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB"))


def colour_at(screen, place):
    """The mean colour of a few pixels around a place, from 0 to 1."""
    x, y = (round(coordinate) for coordinate in place)
    return screen[y - 1 : y + 2, x - 1 : x + 2].mean(axis=(0, 1)) / 255


def alike(seen, painted):
    """How like two colours are whatever the light: the cosine between them."""
    return seen @ painted / np.linalg.norm(seen) / np.linalg.norm(painted)


def chosen(page):
    return page.evaluate("chosen")


def test_dishes_stand_where_they_are_in_their_colours(page, begin):
    begin([])
    screen = picture(page)
    for number, category in enumerate(PRESENT):
        if category != "glass":  # one looks through it
            seen = colour_at(screen, where(page, f"view.dishes[{number}]"))
            assert alike(seen, np.array(colour(category, number)[:3])) > 0.96, (number, category)


@pytest.mark.parametrize("category", FIRST_OF)
def test_a_click_on_a_dish_chooses_it(page, begin, category):
    begin([])
    page.mouse.click(*where(page, f"view.dishes[{FIRST_OF[category]}]"))
    assert chosen(page) == [k.FIRST_DISH + FIRST_OF[category]]


def test_the_dish_in_hand_is_held_up(page, begin):
    begin([])
    stood = where(page, "view.dishes[0]")
    page.mouse.click(*stood)
    held = where(page, "view.dishes[0]")
    assert held[1] < stood[1] - 10
    screen, cup = picture(page), np.array(colour("cup", 0)[:3])
    assert alike(colour_at(screen, held), cup) > 0.96 > alike(colour_at(screen, stood), cup)


def test_clicks_on_the_door_and_the_racks_move_them(page, begin):
    begin([])
    page.mouse.click(*where(page, "view.model.door", 0, -0.02, 0.4))
    for rack in ("top", "top", "bottom"):
        page.mouse.click(*where(page, f"view.model.racks.{rack}", 0, -0.25, 0.05))
    assert chosen(page) == [k.DOOR, k.TOP_RACK, k.TOP_RACK, k.BOTTOM_RACK]
    assert page.evaluate("[state.doorOpen, state.out]") == [True, "bottom"]


def test_the_closed_door_hides_the_racks(page, begin):
    begin([])
    page.mouse.click(*where(page, "view.model.racks.top", 0, -0.25, 0.05))
    assert chosen(page) == [k.DOOR]


def test_a_click_on_a_placement_puts_the_dish_there(page, begin):
    begin([*IN_THE_TOP, CUP])
    for instance in free_of(page)[::8]:
        begin([*IN_THE_TOP, CUP])
        page.mouse.click(*placement_on_screen(page, instance))
        assert chosen(page) == [instance]
        assert page.evaluate("[state.held, state.places[0]]") == [None, "top"]
    seen = colour_at(picture(page), where(page, "view.dishes[0]", -0.02, 0, 0))
    assert alike(seen, np.array(colour("cup", 0)[:3])) > 0.9


def test_a_ghost_stands_where_the_dish_would(page, begin):
    begin([*IN_THE_TOP, BIG_PLATE])
    instance = free_of(page)[20]
    place = placement_on_screen(page, instance)
    without = colour_at(picture(page), place)
    page.mouse.move(*place)
    assert (colour_at(picture(page), place) - without).argmax() == GREEN
    told = page.locator(".told")
    assert told.text_content() == f"instance {instance}"
    page.mouse.move(5, 5)
    assert told.is_hidden()


def test_a_blocked_placement_is_red_and_chosen_only_for_the_refusal(page, begin):
    begin([*IN_THE_TOP, CUP])
    taken = free_of(page)[0]
    begin([*IN_THE_TOP, CUP, taken, CUP + 4])
    place = placement_on_screen(page, taken)
    without = colour_at(picture(page), place)
    page.mouse.move(*place)
    assert (colour_at(picture(page), place) - without).argmax() == RED
    page.mouse.click(*place)
    assert chosen(page) == [taken]
    assert page.locator("#said").text_content() == (
        "The placement is blocked by a dish in the rack."
    )


def test_the_sink_takes_only_a_dish_in_hand(page, begin):
    basin = ("view.model.kitchen", -0.75, 0.25, 0.94)
    begin([])
    page.mouse.click(*where(page, *basin))
    assert chosen(page) == []
    begin([CUP])
    page.mouse.click(*where(page, *basin))
    assert chosen(page) == [k.SINK]
    assert page.evaluate("view.dishes[0].position.toArray()") == pytest.approx(SINK_POSITION)


def test_an_orbit_chooses_nothing_and_stays_before_the_kitchen(page, begin):
    begin([])
    start = where(page, "view.dishes[0]")
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(start[0] + 3000, start[1] - 3000, steps=3)
    page.mouse.up()
    x, y, z = page.evaluate("view.stage.camera.position.toArray()")
    assert chosen(page) == []
    assert x < -2
    assert y < 0 < z


def test_a_zoom_needs_ctrl_and_ends_before_the_cabinets(page, begin):
    begin([])
    page.mouse.move(*where(page, "view.dishes[0]"))
    far = page.evaluate("view.stage.controls.getDistance()")
    page.mouse.wheel(0, -500)
    assert page.evaluate("view.stage.controls.getDistance()") == far
    page.keyboard.down("Control")
    page.mouse.wheel(0, -5000)
    page.keyboard.up("Control")
    page.wait_for_function(f"view.stage.controls.getDistance() < {far / 2}")
    _, y, z = page.evaluate("view.stage.camera.position.toArray()")
    assert y < -0.2
    assert z > 0


def test_it_draws_only_when_something_changes(page, begin):
    begin([])
    frames = "view.stage.renderer.info.render.frame"
    before = page.evaluate(f"drawn().then(() => {frames})")
    assert page.evaluate(f"frame().then(frame).then(() => {frames})") == before
    page.mouse.move(*where(page, "view.dishes[0]"))
    page.evaluate("drawn()")
    assert page.evaluate(frames) > before


def test_movements_are_short_and_none_for_who_asks_for_none(page, begin):
    top = "view.model.racks.top.position.y"
    begin([k.DOOR])
    closed = page.evaluate(top)
    page.evaluate("decide(state, TOP_RACK); show();")
    assert page.evaluate(top) == pytest.approx(closed - RACK_TRAVEL)
    page.emulate_media(reduced_motion="no-preference")
    assert page.evaluate(f"decide(state, TOP_RACK); show(); {top}") < closed - 0.1
    page.evaluate("drawn()")
    assert page.evaluate(top) == pytest.approx(closed)
    page.emulate_media(reduced_motion="reduce")


def test_the_dark_theme_dims_the_light_whoever_asks_for_it(page, begin):
    begin([])
    light = picture(page).mean()
    page.emulate_media(color_scheme="dark")
    dark = picture(page).mean()
    page.evaluate("document.documentElement.dataset.theme = 'light'")
    assert picture(page).mean() == pytest.approx(light, abs=1)
    page.evaluate("delete document.documentElement.dataset.theme")
    page.emulate_media(color_scheme="light")
    assert dark < 0.75 * light


def test_on_a_phone_all_of_the_kitchen_is_in_sight(page, begin):
    page.set_viewport_size({"width": 390, "height": 700})
    page.evaluate("frame().then(frame)")
    begin([])
    for end in (-2.4, 1.0):
        x, _ = where(page, "view.model.kitchen", end, 0.0, 0.94)
        assert 0 < x < 390
    place = where(page, "view.dishes[0]")
    assert alike(colour_at(picture(page), place), np.array(colour("cup", 0)[:3])) > 0.9
    page.mouse.click(place[0], place[1] - 9)  # a fingertip beside the cup
    assert chosen(page) == [CUP]
    page.set_viewport_size(SCREEN)


def test_who_does_not_see_the_canvas_is_sent_to_the_drawing(page):
    label = page.locator("#kitchen canvas").get_attribute("aria-label")
    assert "the drawing" in label


def test_a_browser_without_webgl_is_told_apart(page):
    assert page.evaluate("Kitchen3D.available()")
    without = """() => {
      const { getContext } = HTMLCanvasElement.prototype;
      HTMLCanvasElement.prototype.getContext = () => null;
      const available = Kitchen3D.available();
      HTMLCanvasElement.prototype.getContext = () => { throw new Error("no"); };
      const failing = Kitchen3D.available();
      HTMLCanvasElement.prototype.getContext = getContext;
      return [available, failing];
    }"""
    assert page.evaluate(without) == [False, False]


def test_a_damaged_file_is_told_and_a_closed_view_leaves_nothing(page):
    result = """async () => {
      const element = document.body.appendChild(html("div"));
      const other = new Kitchen3D(element, new ArrayBuffer(40), data.layout, {});
      const told = await other.ready.then(() => "read", (error) => error.name);
      other.dispose();
      const left = element.childElementCount;
      element.remove();
      return [told, left];
    }"""
    told, left = page.evaluate(result)
    assert told != "read"
    assert left == 0
