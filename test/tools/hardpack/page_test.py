# SPDX-License-Identifier: Apache-2.0
"""The page of a mission, in headless Chromium: it loads nothing, says what run.json says, and its
slider, keys and events move what is drawn. HARDPACK_PAGE_PICTURES: a folder for screenshots."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import browser
from browser import Browser

COMMAND = os.environ["HARDPACK_COMMAND"]
SKIPPED = 77
MOST_BYTES = 5_000_000

# A number that differs where one pixel of a canvas does.
PIXELS = """((id) => {
  const canvas = document.getElementById(id) || document.querySelector(`[data-plot="${id}"]`);
  const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  let sum = 0;
  for (const byte of data) sum = (Math.imul(sum, 31) + byte) | 0;
  return sum;
})"""
# How many pixels of the live canvas have a colour.
COLOURED = """((r, g, b) => {
  const canvas = document.getElementById('live');
  const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  let found = 0;
  for (let i = 0; i < data.length; i += 4) {
    found += data[i] === r && data[i + 1] === g && data[i + 2] === b && data[i + 3] === 255;
  }
  return found;
})"""
YELLOW, BLUE = (240, 228, 66), (0, 114, 178)


def share_of(histogram, share):
    """The upper edge of the bin with that share of all that was counted."""
    left = share * (sum(n for _, n in histogram["bins"]) + histogram["beyond"])
    for index, n in histogram["bins"]:
        left -= n
        if left <= 0:
            return (index + 1) * histogram["width"]
    return float("inf")


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="page_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        # A world in which it plans anew under way; it does not matter here how it ends.
        run = subprocess.run([COMMAND, "sim", "--world", "rock_pile", "--seed", "2", "--limit", "9",
                              "--lidar-columns", "512", "--replay", "--out", cls.folder],
                             capture_output=True, text=True, timeout=300, check=False)
        if run.returncode > 1:
            raise AssertionError(run.stderr)
        cls.run_json = json.loads((cls.folder / "run.json").read_text())
        cls.path = cls.folder / "page.html"
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        self.browser.problems.clear()
        self.browser.requests.clear()
        self.browser.size(1440, 1000)
        self.browser.open(self.path)
        self.addCleanup(lambda: self.assertEqual(self.browser.problems, []))

    def value(self, expression):
        return self.browser.value(expression)

    def pixels(self, canvas):
        return self.value(f"{PIXELS}('{canvas}')")

    def coloured(self, colour):
        return self.value(f"{COLOURED}({', '.join(map(str, colour))})")

    def clock(self):
        return float(self.value("document.getElementById('clock').textContent").split()[0])

    def fact(self, key):
        return self.value(f"document.querySelector('[data-key={key}]').textContent")

    def test_it_loads_nothing_and_is_small(self):
        self.assertEqual(self.browser.requests, [self.path.resolve().as_uri()])
        self.assertLess(self.path.stat().st_size, MOST_BYTES)
        text = self.path.read_text()
        for mark in ("src=", "@import", "url(", "http://", "https://"):
            self.assertNotIn(mark, text)

    def test_its_numbers_are_those_of_run_json(self):
        run = self.run_json
        for key, digits in (("time_s", 2), ("driven_m", 2), ("max_speed_mps", 2),
                            ("clearance_m", 2), ("jerk_rms_mps3", 2)):
            self.assertEqual(self.fact(key).split("\u00a0")[0], f"{run[key]:.{digits}f}", key)
        for key in ("replans", "stops", "seed", "world", "vehicle", "decision_hash"):
            self.assertEqual(self.fact(key), str(run[key]), key)
        self.assertTrue(self.fact("outcome").startswith(run["outcome"]))
        self.assertTrue(run["replayed"])
        self.assertIn("every tick the same", self.fact("replayed"))
        for key, histogram, share, digits in (
                ("reaction_median_m", "reaction_m", 0.5, 2), ("reaction_p99_m", "reaction_m", 0.99, 2),
                ("cross_track_p95_m", "cross_track_m", 0.95, 3)):
            wanted = share_of(run[histogram], share)
            text = "beyond" if wanted == float("inf") else f"{wanted:.{digits}f}"
            self.assertEqual(self.fact(key).split("\u00a0")[0], text, key)
        self.assertEqual(self.value("mission.run"), run)

    def test_the_slider_moves_plan_way_and_vehicle(self):
        self.assertEqual(self.clock(), 0.01)
        before = {"yellow": self.coloured(YELLOW), "live": self.pixels("live"),
                  "ground": self.pixels("ground"), "Speed": self.pixels("Speed")}
        last = self.value("count - 1")
        self.assertGreater(last, 100)
        self.value(f"(slider.value = {last // 2}, slider.dispatchEvent(new Event('input')), 0)")
        self.assertAlmostEqual(self.clock(), self.value(f"samples.t_s[{last // 2}]"), places=2)
        self.assertGreater(self.coloured(YELLOW), before["yellow"] + 100)
        self.assertGreater(self.coloured(BLUE), 100)
        for canvas in ("live", "ground", "Speed"):
            self.assertNotEqual(self.pixels(canvas), before[canvas], canvas)

    def test_a_plan_is_drawn_from_its_time_on(self):
        """The path that is drawn is the last one that was committed by then."""
        self.assertGreater(len(self.value("plans")), 1)
        self.value("show(0)")
        told = []
        for _ in range(3):
            self.browser.key("n")
            told.append((self.value("lastBy(plans, samples.t_s[player.i])"), self.coloured(BLUE)))
        self.assertEqual([index for index, _ in told][:2], [0, 1])
        self.assertNotEqual(told[0][1], told[1][1])
        self.browser.key("p")
        self.assertEqual(self.value("lastBy(plans, samples.t_s[player.i])"), told[-1][0] - 1)

    def test_keys_and_playing(self):
        self.browser.key("ArrowRight")
        self.assertEqual(self.value("player.i"), 1)
        self.browser.key("ArrowRight", modifiers=8)
        self.assertEqual(self.value("player.i"), 21)
        self.browser.key("ArrowLeft")
        self.assertEqual(self.value("player.i"), 20)
        self.browser.key("End")
        self.assertEqual(self.value("player.i"), self.value("count - 1"))
        self.browser.key("Home")
        self.assertEqual(self.value("player.i"), 0)
        self.browser.key(" ")
        self.assertTrue(self.value("player.playing"))
        # Frames come as the browser has time for them.
        self.value("new Promise((done) => { const ask = () => player.i > 4 ? done(0) : "
                   "setTimeout(ask, 20); ask(); })")
        self.browser.key(" ")
        self.assertFalse(self.value("player.playing"))

    def test_an_event_takes_the_slider_to_its_time(self):
        events = self.value("events")
        index = next(i for i, event in enumerate(events) if event["text"] == "driving")
        self.value("show(count - 1)")
        at = self.value(f"(() => {{ const box = document.querySelectorAll('#events button')[{index}]"
                        ".getBoundingClientRect(); return [box.x + 20, box.y + 8]; })()")
        self.browser.click(*at)
        self.assertAlmostEqual(self.clock(), events[index]["t_s"], delta=0.06)
        self.assertEqual(
            self.value("document.querySelector('#events .last').textContent").split(" s")[1],
            "driving")

    def test_a_phone_sees_all_of_its_width(self):
        self.browser.size(390, 844, mobile=True)
        self.browser.open(self.path)
        self.assertLessEqual(self.value("document.documentElement.scrollWidth"), 390)
        self.assertGreater(self.value("groundCanvas.clientWidth"), 340)

    def test_scales_are_equal(self):
        """10 m ahead and 10 m to the left are as many pixels."""
        self.assertAlmostEqual(*self.value(
            "[toPx([10, 0])[0] - toPx([0, 0])[0], toPx([0, 0])[1] - toPx([0, 10])[1]]"), places=6)

    def test_pictures(self):
        folder = os.environ.get("HARDPACK_PAGE_PICTURES")
        if not folder:
            self.skipTest("HARDPACK_PAGE_PICTURES is not set")
        for part in (0.0, 0.5, 1.0):
            self.value(f"show(Math.round({part} * (count - 1)))")
            self.browser.screenshot(pathlib.Path(folder) / f"page_{part}.png")


if __name__ == "__main__":
    if browser.CHROMIUM is None:
        print("there is no chromium")
        sys.exit(SKIPPED)
    unittest.main()
