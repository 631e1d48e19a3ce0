"""A real browser: Debian's Chromium without a screen, WebGL drawn by SwiftShader."""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

MISSING = "no Chromium found (apt-get install chromium)"
ARGUMENTS = (
    "--no-sandbox",  # it runs as root in a container
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--no-first-run",
    "--disable-quic",
    "--disable-sync",
    "--disable-background-networking",
    "--disable-component-update",
)


def chromium() -> str:
    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if found is None:
        if os.environ.get("CI") == "true":
            pytest.fail(MISSING)
        pytest.skip(MISSING)
    return found


@pytest.fixture(scope="session")
def launch() -> Iterator[Callable[..., Any]]:
    """Starts a browser with further arguments."""
    executable = chromium()
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browsers: list[Any] = []

        def start(*more: str) -> Any:
            browsers.append(playwright.chromium.launch(executable_path=executable, args=[*ARGUMENTS, *more]))
            return browsers[-1]

        yield start
        for browser in browsers:
            browser.close()


@pytest.fixture(scope="session")
def browser(launch: Callable[..., Any]) -> Any:
    return launch()


@dataclass
class Visit:
    """A page that was opened, with everything it said and asked for."""

    page: Any
    console: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def listen(self) -> None:
        self.page.on("console", lambda message: self.console.append(f"{message.type}: {message.text}"))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))

    def open(self, path: Path, state: str = "ready") -> None:
        self.page.goto(path.as_uri())
        self.page.wait_for_selector(f'html[data-state="{state}"]', state="attached", timeout=60_000)


@pytest.fixture
def visit(browser: Any) -> Iterator[Callable[..., Visit]]:
    """Opens a file in a fresh window of a given size and waits until the picture is drawn."""
    contexts: list[Any] = []

    def start(path: Path, width: int = 1280, height: int = 800, wait: bool = True) -> Visit:
        context = browser.new_context(viewport={"width": width, "height": height})
        contexts.append(context)
        visited = Visit(context.new_page())
        visited.listen()
        if wait:
            visited.open(path)
        else:
            visited.page.goto(path.as_uri())
        return visited

    yield start
    for context in contexts:
        context.close()
