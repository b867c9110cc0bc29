"""A Chromium without a window, asked over its debugging pipe: no driver, no socket, no network.

`open_browser` starts one and gives its only tab; `Tab` opens pages and asks them with JavaScript.
The names of commands and events are those of the Chrome DevTools Protocol.
"""

import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager, suppress

from tools.command import child

PROGRAMS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
OPTIONS = (
    "--headless --remote-debugging-pipe --no-sandbox --disable-gpu --disable-dev-shm-usage "
    "--no-first-run --disable-background-networking --disable-component-update "
    "--disable-default-apps --disable-extensions --disable-sync --hide-scrollbars --mute-audio"
).split()
NO_NETWORK = "--host-resolver-rules=MAP * ~NOTFOUND"
# The browser reads commands from descriptor 3 and writes to 4, whatever those are here.
AS_3_AND_4 = """
import fcntl, os, sys
for there, here in zip((3, 4), [fcntl.fcntl(int(fd), fcntl.F_DUPFD, 10) for fd in sys.argv[1:3]]):
    os.dup2(here, there)
os.execv(sys.argv[3], sys.argv[3:])
"""
PATIENCE = 60  # seconds for an answer: a busy machine is slow, a hung page never answers
# Codes of the keys that a page may listen to.
KEYS = {
    **{"Tab": 9, "Enter": 13, "Escape": 27, " ": 32, "PageUp": 33, "PageDown": 34, "End": 35},
    **{"Home": 36, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40},
}
LOCAL = ("file:", "data:", "blob:", "about:")


def program():
    """Return the path of a Chromium: the one that CHROMIUM names, or one of the path, or None."""
    return os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, PROGRAMS)), None)


@contextmanager
def open_browser(path, home):
    """Start the program at a path; yield its tab, for the pages of a folder."""
    to_read, commands = os.pipe()
    answers, to_write = os.pipe()
    start = [sys.executable, "-ISc", AS_3_AND_4, str(to_read), str(to_write), path, *OPTIONS]
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        start += [NO_NETWORK, f"--user-data-dir={profile}"]
        fds = {"pass_fds": (to_read, to_write), "stderr": subprocess.DEVNULL}
        with child(start, **fds) as process:
            os.close(to_read)
            os.close(to_write)
            tab = Tab(commands, answers, home)
            try:
                yield tab
            finally:
                with suppress(OSError):
                    tab.send("Browser.close")
                    process.wait(10)
                os.close(commands)
                os.close(answers)


class Tab:
    """The tab of a browser; what it complains of since a page was opened is in `complaints`."""

    def __init__(self, commands, answers, home):
        self.home = home
        self._commands, self._answers = commands, answers
        self._number, self._received, self._session = 0, b"", {}
        self._loaded = False
        self.complaints = []
        target = self.call("Target.createTarget", url="about:blank")
        attached = self.call("Target.attachToTarget", **target, flatten=True)
        self._session = {"sessionId": attached["sessionId"]}
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def send(self, method, **parameters):
        """Send a command, without waiting for its answer; return its number."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters} | self._session
        left = json.dumps(message).encode() + b"\0"
        while left:
            left = left[os.write(self._commands, left) :]
        return self._number

    def call(self, method, **parameters):
        """Send a command; return what it answers."""
        number = self.send(method, **parameters)
        while (message := self._receive()).get("id") != number:
            pass
        if "error" in message:
            raise RuntimeError(f"{method}: {message['error']['message']}")
        return message["result"]

    def _receive(self):
        """Return the next message, after noting what it complains of."""
        end = time.monotonic() + PATIENCE
        while b"\0" not in self._received:
            if not select.select([self._answers], [], [], max(end - time.monotonic(), 0))[0]:
                raise TimeoutError(f"no answer of the browser in {PATIENCE} s")
            if not (more := os.read(self._answers, 1 << 20)):
                raise EOFError("the browser has ended")
            self._received += more
        line, _, self._received = self._received.partition(b"\0")
        message = json.loads(line)
        self._note(message.get("method"), message.get("params", {}))
        return message

    def _note(self, event, told):
        match event:
            case "Page.loadEventFired":
                self._loaded = True
            case "Network.requestWillBeSent" if not told["request"]["url"].startswith(LOCAL):
                self.complaints.append(f"asks the network for {told['request']['url']}")
            case "Network.loadingFailed":
                self.complaints.append(f"a {told['type']} is not loaded: {told['errorText']}")
            case "Log.entryAdded" if told["entry"]["level"] in {"error", "warning"}:
                self.complaints.append(f"{told['entry']['text']} {told['entry'].get('url', '')}")
            case "Runtime.consoleAPICalled" if told["type"] in {"error", "warning", "assert"}:
                words = [str(a.get("value", a.get("description"))) for a in told["args"]]
                self.complaints.append(f"console: {' '.join(words)}")
            case "Runtime.exceptionThrown":
                details = told["exceptionDetails"]
                what = details.get("exception", {}).get("description", details["text"])
                self.complaints.append(f"uncaught: {what}")

    def open(self, page, width=1440, theme="light"):
        """Open a page at a width in px, in a theme; return once its formulas are set."""
        self.complaints.clear()
        self.resize(width)
        self.wear(theme)
        self._loaded = False
        self.call("Page.navigate", url=(self.home / page).as_uri())
        self.arrive()

    def arrive(self):
        """Return once the page that is being opened is there, with its formulas."""
        while not self._loaded:
            self._receive()
        self._loaded = False
        self.run("window.MathJax?.startup?.promise?.then(() => null)")

    def resize(self, width, height=900):
        """Give the page a size in px."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.call("Emulation.setDeviceMetricsOverride", **size)

    def wear(self, theme):
        """Have the system ask for a theme, "light" or "dark"."""
        feature = {"name": "prefers-color-scheme", "value": theme}
        self.call("Emulation.setEmulatedMedia", features=[feature])

    def run(self, script):
        """Return the value of a JavaScript expression; a promise is awaited."""
        options = {"awaitPromise": True, "returnByValue": True, "userGesture": True}
        answer = self.call("Runtime.evaluate", expression=script, **options)
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return answer["result"].get("value")

    def wait(self, script):
        """Return the value of a JavaScript expression once it is true, or has some length."""
        end = time.monotonic() + PATIENCE
        while not (value := self.run(script)):
            if time.monotonic() > end:
                raise TimeoutError(f"{script} is {value!r} after {PATIENCE} s")
            self.settle()
        return value

    def on(self, selector, script):
        """Return the value of an expression of `e`, the first element that a selector meets."""
        return self.run(f"((e) => {script})(document.querySelector({json.dumps(selector)}))")

    def text(self, selector):
        """Return the text of an element, as it is shown."""
        return self.on(selector, "e.innerText.trim()")

    def set(self, selector, value):
        """Give a slider, a box or a list a value, as a reader would."""
        key = "checked" if isinstance(value, bool) else "value"
        fire = "for (const kind of ['input', 'change']) e.dispatchEvent(new Event(kind, bubbling))"
        head = f"const bubbling = {{ bubbles: true }}; e.{key} = {json.dumps(value)}"
        self.on(selector, f"{{ {head}; {fire} }}")
        self.settle()

    def press(self, key, selector=None):
        """Press a key, on an element that gets the focus first if there is a selector."""
        if selector:
            self.on(selector, "e.focus()")
        told = {"key": key, "code": key, "windowsVirtualKeyCode": KEYS[key]}
        text = {"Enter": {"text": "\r"}, " ": {"text": " "}}.get(key, {})
        self.call("Input.dispatchKeyEvent", type="keyDown", **told, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", **told)
        self.settle()

    def type(self, text):
        """Type into what has the focus."""
        self.call("Input.insertText", text=text)

    def drag(self, selector, start, end):
        """Drag the pointer over an element; places are fractions of its width and height."""
        self.on(selector, "e.scrollIntoView({ block: 'center', behavior: 'instant' })")
        box = self.on(selector, "e.getBoundingClientRect().toJSON()")
        left, top, width, height = (box[key] for key in ("x", "y", "width", "height"))
        middle = [(a + b) / 2 for a, b in zip(start, end, strict=True)]
        steps = ("mousePressed", start), ("mouseMoved", middle), ("mouseMoved", end)
        for kind, (x, y) in (*steps, ("mouseReleased", end)):
            where = {"x": left + x * width, "y": top + y * height}
            button = {"button": "left", "buttons": 1, "clickCount": 1}
            self.call("Input.dispatchMouseEvent", type=kind, **where, **button)
        self.settle()

    def settle(self):
        """Return when what was asked for has been drawn, or the page has been left."""
        with suppress(RuntimeError):
            self.run("new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")
