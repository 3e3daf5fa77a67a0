"""Pages in Debian's chromium, without a window and without a network."""

from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

from kitchen_prefs.web.page import self_contained_page

CHROMIUM = Path("/usr/bin/chromium")
PATIENCE = 120_000  # milliseconds; the machine may be busy

# A page that shows nothing.
BARE = """<!doctype html><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="$policy"><link rel="icon" href="data:,">
<style>$style</style><script type="application/json" id="data">$data</script>
<script>$script</script>"""

needs_chromium = pytest.mark.skipif(not CHROMIUM.exists(), reason="needs Debian's chromium")


@contextmanager
def running_chromium():
    """A browser without a window."""
    with sync_playwright() as driver:
        browser = driver.chromium.launch(
            executable_path=str(CHROMIUM), args=["--no-sandbox"], timeout=PATIENCE
        )
        yield browser
        browser.close()


@contextmanager
def opened(browser, file, **options):
    """A file as a page; at the end its console is empty and it has fetched nothing."""
    page = browser.new_page(**options)
    page.set_default_timeout(PATIENCE)
    messages, requests = [], []
    page.on("console", lambda message: messages.append(message.text))
    page.on("pageerror", lambda error: messages.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.goto(file.as_uri())
    yield page
    page.close()
    assert messages == []
    assert [url for url in requests if not url.startswith("data:")] == [file.as_uri()]


@contextmanager
def bare_page(file, script, data):
    """A page with a script and data and nothing to see, written to a file and opened."""
    file.write_text(self_contained_page(BARE, "", script, data))
    with running_chromium() as browser, opened(browser, file) as page:
        yield page
