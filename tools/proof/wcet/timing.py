#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the static bounds of a tick's work against their budgets and against measurements.

usage: tools/proof/wcet/timing.py [--facts FILE] [--measured FILE]... [--set NAME=N]... [--json]
                            [--budgets] [--schedule] IMAGE

Reads config/timing.toml (--facts): the assumptions of the bounds, the bounded work and the budgets.
Prints a table, and reports every budget that is exceeded and every measurement that exceeds its
bound.

  --measured FILE  lines "name number" of a run of the same code: test/timing/measure_units and
                   test/bare_metal/replay_tape. Lines "constant name number" must agree with the
                   facts, those of parameters only if they are not set otherwise.
  --set NAME=N     another value of one of the facts' parameters; budgets are then not checked
  --json           the table as JSON
  --schedule       also estimate their time on the processor of the facts' schedule
  --budgets        print the budgets in the format of the facts' file, each 5 % above its bound

Exit code: 0 passed; 1 a bound is not as it should be, or cannot be guaranteed; 2 bad usage.
"""

import argparse
import ast
import json
import operator
import pathlib
import sys
import tomllib

from bound import Analysis
from image import EM_ARM, Image, Refused
from schedule import Schedule, print_schedule

ROOT = pathlib.Path(__file__).resolve().parents[3]
FACTS = ROOT / "config" / "timing.toml"
OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul}


def evaluate(text, values):
    """A sum of products of numbers and names; ceil(a, b) is the quotient, rounded up."""
    def of(node):
        if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            return OPERATORS[type(node.op)](of(node.left), of(node.right))
        if isinstance(node, ast.Constant) and isinstance(node.value, int):
            return node.value
        if isinstance(node, ast.Name) and node.id in values:
            return values[node.id]
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "ceil":
            first, second = map(of, node.args)
            return -(-first // second)
        raise Refused(f"{text}: not understood")
    return of(ast.parse(str(text), mode="eval").body)


class Facts:
    """As the file says them, with the parameters that were set otherwise."""

    def __init__(self, path, changed=()):
        with open(path, "rb") as file:
            self.table = tomllib.load(file)
        for name, _ in changed:
            if name not in self.table["parameters"]:
                raise Refused(f"{name} is not one of the parameters")
        self.unchanged = {name: value for name, value in self.table["parameters"].items()
                          if name not in dict(changed)}
        self.values = {**self.table["constants"], **self.table["parameters"], **dict(changed)}

    def image(self, path):
        return Image(path, self.table["stops"], beams=self.values["beams"])

    def analysis(self, image, **units):
        """units: other numbers of rounds than the file's, by function."""
        rounds = {name: evaluate(entry["most"], self.values)
                  for entry in self.table["units"] for name in entry["of"]}
        excluded = {name: 0 for entry in self.table.get("excluded", [])
                    if self.values[entry["where"]] == 0 for name in entry["of"]}
        return Analysis(image, given=excluded, units={**rounds, **units.get("units", {})},
                        calls=self._scoped("calls"), rounds=self._scoped("rounds"))

    def idle_analysis(self, image):
        """Of a tick that has nothing to plan."""
        planner = self.table["idle"]["within"]
        analysis = self.analysis(image, units={planner: 0})
        start = image.named(planner).start
        nothing = {image.named(name).start: 0 for name in self.table["idle"]["of"]}
        analysis.calls[start] = {**analysis.calls.get(start, {}), **nothing}
        return analysis

    def _scoped(self, kind):
        scopes = {}
        for entry in self.table.get(kind, []):
            most = evaluate(entry["most"], self.values)
            least = evaluate(entry.get("at_least", 0), self.values)
            if most < least:
                raise Refused(f"{entry['of'][0]}: {entry['most']} are {most}, fewer than {least}")
            for within, of in self._of_vehicles(entry):
                scopes.setdefault(within, {}).update(dict.fromkeys(of, most))
        return scopes

    def _of_vehicles(self, entry):
        """What holds of the tick of the first of `vehicles` holds of that of each other, but for the
        functions of devices (`devices`) that it does not have."""
        yield entry["within"], entry["of"]
        first, *others = self.table.get("vehicles", [""])
        if f"<hardpack::{first}>" not in entry["within"]:
            return
        for other in others:
            foreign = tuple(self.table["foreign"][other])
            of = [name.replace(f"<hardpack::{first}>", f"<hardpack::{other}>")
                  for name in entry["of"] if not name.startswith(foreign)]
            if of:
                yield entry["within"].replace(f"<hardpack::{first}>", f"<hardpack::{other}>"), of


def bounds(facts, image):
    """[(entry, bound)] of what is to be bounded."""
    analysis = facts.analysis(image)
    idle = facts.idle_analysis(image)
    found = []
    for entry in facts.table["bounds"]:
        if entry["kind"] == "round":
            value = analysis.round(entry["function"])
        elif entry["kind"] == "idle":
            value = idle.bound(entry["function"])
        else:
            value = analysis.bound(entry["function"])
        found.append((entry, value))
    return found


def schedule(facts, path, image):
    """With the bounds of the configuration that the facts name, of the image at a path."""
    with open(ROOT / facts.table["schedule"]["configuration"], "rb") as file:
        tick = tomllib.load(file)["tick"]
    changed = [(name, value) for name, value in tick.items() if name in facts.table["parameters"]]
    changed += [(name, value) for name, value in facts.table["schedule"].items()
                if name in facts.table["parameters"]]
    of_schedule = Facts(path, changed)
    found = bounds(of_schedule, of_schedule.image(image))
    return Schedule(facts, tick, {entry["name"]: value for entry, value in found})


def read_measured(paths):
    """{name: the largest number}, and {constant: value}."""
    numbers, constants = {}, {}
    for path in paths:
        with open(path, encoding="utf-8") as file:
            for line in file:
                *name, number = line.split() or [""]
                if not name or not number.isdigit():
                    continue
                if name[0] == "constant":
                    constants[" ".join(name[1:])] = int(number)
                else:
                    name = " ".join(name)
                    numbers[name] = max(numbers.get(name, 0), int(number))
    return numbers, constants


def differences(facts, constants):
    """What is wrong with the facts' constants and defaults, if the sources' are known."""
    wrong = []
    for name, value in facts.table["constants"].items():
        if constants and constants.get(name) != value:
            wrong.append(f"the constant {name} is {constants.get(name)}, not {value}")
    for name, value in facts.unchanged.items():
        if constants.get(name, value) != value:
            wrong.append(f"the parameter {name} is {constants[name]} by default, not {value}")
    return wrong


def judge(facts, found, numbers, target, with_budgets):
    """Rows of the table, and what is wrong."""
    rows, wrong = [], []
    for entry, value in found:
        measured = numbers.get(entry.get("measured"))
        row = {"name": entry["name"], "bound": value, "budget": entry.get(target),
               "measured": measured, "ratio": value / measured if measured else None}
        rows.append(row)
        if measured is not None and measured > value:
            wrong.append(f"{row['name']}: measured {measured}, more than its bound of {value}")
        if with_budgets and not value <= (row["budget"] or 0):
            wrong.append(f"{row['name']}: {value} are more than its budget of {row['budget']}")
        if numbers and "measured" in entry and measured is None:
            wrong.append(f"{row['name']}: {entry['measured']} was not measured")
    return rows, wrong


def print_table(rows):
    print(f"{'instructions of':44} {'bound':>13} {'budget':>13} {'measured':>11} {'ratio':>6}")
    for row in rows:
        def text(key, form):
            return format(row[key], form) if row[key] is not None else "-"
        print(f"{row['name']:44} {row['bound']:13,d} {text('budget', ',d'):>13} "
              f"{text('measured', ',d'):>11} {text('ratio', '.2f'):>6}")


def print_budgets(rows, target):
    """Rounded up to three digits."""
    for row in rows:
        wanted = row["bound"] * 105 // 100
        digit = 10 ** max(0, len(str(wanted)) - 3)
        print(f'{row["name"]}: {target} = {-(-wanted // digit) * digit}')


def report(wrong):
    """Prints what is wrong; the exit code."""
    for text in wrong:
        print(f"timing: {text}", file=sys.stderr)
    return 1 if wrong else 0


def read_change(text):
    name, _, value = text.partition("=")
    if not value.isdigit():
        raise argparse.ArgumentTypeError(f"{text} is not NAME=N")
    return name, int(value)


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     usage=argparse.SUPPRESS)
    parser.add_argument("--facts", default=FACTS)
    parser.add_argument("--measured", action="append", default=[])
    parser.add_argument("--set", action="append", type=read_change, default=[])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--budgets", action="store_true")
    parser.add_argument("--schedule", action="store_true")
    parser.add_argument("image")
    options = parser.parse_args(arguments)
    try:
        facts = Facts(options.facts, options.set)
        numbers, constants = read_measured(options.measured)
        wrong = differences(facts, constants)
        if wrong:  # bounds that rest on them say nothing
            return report(wrong)
        if options.schedule:
            print_schedule(schedule(facts, options.facts, options.image), numbers)
            return 0
        image = facts.image(options.image)
        found = bounds(facts, image)
        target = "cortex_m7" if image.machine == EM_ARM else "aarch64"
    except (OSError, KeyError, tomllib.TOMLDecodeError, Refused) as reason:
        print(f"timing: {reason}", file=sys.stderr)
        return 2 if isinstance(reason, OSError) else 1
    rows, wrong = judge(facts, found, numbers, target, not options.set)
    if options.json:
        print(json.dumps(rows, indent=1))
    elif options.budgets:
        print_budgets(rows, target)
        return 0
    else:
        print_table(rows)
    return report(wrong)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
