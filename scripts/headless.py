"""A page in headless Chromium, used as a person would: by the DevTools protocol, through a pipe, without further packages."""

import base64
import json
import os
import shutil
import subprocess
import tempfile

PROGRAMS = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable",
            "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome"]


def find():
    """The path of a Chromium, or None."""
    return next(filter(None, map(shutil.which, PROGRAMS)), None)


class Page:
    """A page, open until the end of a `with` block. `problems` collects errors, messages on the console and loads from
    elsewhere."""

    def __init__(self, program, address, width=1280, height=900):
        self.problems, self.last, self.buffer, self.session = [], 0, b"", None
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.process = self._start(program, [f"--user-data-dir={self.profile.name}", f"--window-size={width},{height}"])
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.address = address
        self.reopen([])

    def reopen(self, features):
        """Loads the page anew, with some media features of the user: name and value."""
        self.call("Emulation.setEmulatedMedia", features=features)
        self.call("Page.navigate", url=self.address)
        self._wait("Page.loadEventFired")

    def _start(self, program, options):
        # Chromium reads commands from file 3 and writes answers and events to file 4.
        commands, self.write = os.pipe()
        self.read, answers = os.pipe()
        fixed = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
                 "--remote-debugging-pipe"]
        # A shell moves the pipes to these numbers.
        line = f'exec "$0" "$@" 3<&{commands} 4>&{answers}'
        process = subprocess.Popen(["bash", "-c", line, program, *fixed, *options], pass_fds=(commands, answers),
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(commands)
        os.close(answers)
        return process

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.session = None
            self.call("Browser.close")
        finally:
            self.process.wait(timeout=60)
            os.close(self.write)
            os.close(self.read)
            self.profile.cleanup()

    def _message(self):
        """The next message: they end with a zero byte."""
        while b"\0" not in self.buffer:
            block = os.read(self.read, 1 << 20)
            if not block:
                raise RuntimeError("Chromium has ended")
            self.buffer += block
        message, self.buffer = self.buffer.split(b"\0", 1)
        message = json.loads(message)
        self._collect(message.get("method"), message.get("params", {}))
        return message

    def _collect(self, event, parameters):
        if event == "Runtime.exceptionThrown":
            details = parameters["exceptionDetails"]
            self.problems.append(details.get("exception", {}).get("description", details["text"]))
        elif event == "Runtime.consoleAPICalled":
            self.problems.append(" ".join(str(word.get("value", word)) for word in parameters["args"]))
        elif event == "Log.entryAdded":
            self.problems.append(parameters["entry"]["text"])
        elif event == "Network.requestWillBeSent" and not parameters["request"]["url"].startswith(("file:", "data:")):
            self.problems.append(f"loads {parameters['request']['url'][:200]}")

    def _wait(self, event):
        while self._message().get("method") != event:
            pass

    def call(self, method, **parameters):
        """Has a command of the protocol done; returns its answer."""
        self.last += 1
        command = {"id": self.last, "method": method, "params": parameters}
        if self.session:
            command["sessionId"] = self.session
        os.write(self.write, json.dumps(command).encode() + b"\0")
        while True:
            message = self._message()
            if message.get("id") == self.last:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']['message']}")
                return message["result"]

    def evaluate(self, expression):
        """The value of a JavaScript expression; of a promise that what it brings."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return answer["result"].get("value")

    def press(self, key, code=0):
        """Presses a key: a character, or the name of a key with its Windows number."""
        text = {"text": key} if len(key) == 1 else {}
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, windowsVirtualKeyCode=code, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key, windowsVirtualKeyCode=code)

    def click(self, selector):
        """Clicks on the middle of an element."""
        x, y = self.evaluate(f"""(() => {{
            const element = document.querySelector({json.dumps(selector)});
            element.scrollIntoView({{ block: "center" }});
            const box = element.getBoundingClientRect();
            return [box.x + box.width / 2, box.y + box.height / 2];
        }})()""")
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def picture(self, path, dark=False):
        """Keeps a picture of the whole page."""
        scheme = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]
        self.call("Emulation.setEmulatedMedia", features=scheme)
        self.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        data = self.call("Page.captureScreenshot", captureBeyondViewport=True)["data"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(data))
