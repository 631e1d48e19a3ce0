"""Mutants of real URDF files through `nao-kin check`, in guarded processes.

python tools/fuzz_check.py                        20 000 mutants; exit status 1 if one breaks a promise
python tools/fuzz_check.py --mutants 500 --seed 1

The promises: every mutant gets a verdict, none takes more than five seconds of processor time, none crashes the
process; and where no error is reported, Pinocchio loads the very bytes, every pose is finite, and yourdfpy agrees on a
seeded few hundred.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

SECONDS = 5.0  # of processor time that one mutant may take; what else the machine does is not its fault
HANG = 120.0  # without a word a process is ended
MEMORY = 4 * 1024**3
BATCH = 250
VERSIONED, MACROS, MUJOCO = 0.15, 0.02, 0.02  # parts; the last two take a process a mutant
COMPARED = 16  # every so many mutants, by yourdfpy too: about 500 of 20 000 that are without errors


def sources() -> list[Path]:
    """The files that mutants are made of: ours, and those of example-robot-data where it is installed."""
    from nao_kin.robot.known import KNOWN_ROBOTS, example_robot_data_share, robot_file

    ours = [robot_file(robot) for robot in KNOWN_ROBOTS.values() if robot.source == "bundled"]
    share = example_robot_data_share()
    theirs = [] if share is None else sorted(share.glob("example-robot-data/robots/**/*.urdf"))
    return [*ours, *theirs]


def mutant_of(number: int, seed: int, files: list[Path]) -> tuple[Path, bytes]:
    """The mutant of that number and what it was made of; the same for the same seed."""
    import numpy as np

    from check_trials.macros import MACRO_FILES, MJCF, macro_file
    from check_trials.mutants import mutant
    from check_trials.versions import versioned_robot

    rng = np.random.default_rng([seed, number])
    kind = float(rng.random())
    if kind < VERSIONED:
        return Path("versioned.urdf"), mutant(versioned_robot(rng), rng)
    if kind < VERSIONED + MACROS:
        name = MACRO_FILES[int(rng.integers(len(MACRO_FILES)))]
        return Path(f"{name}.xacro"), mutant(macro_file(name), rng)
    if kind < VERSIONED + MACROS + MUJOCO:
        return Path("arm.xml"), mutant(MJCF, rng)
    source = files[int(rng.integers(len(files)))]
    return source, mutant(source.read_bytes(), rng)


def examine(source: Path, data: bytes, seed: int, compared: bool) -> dict[str, Any]:
    """The verdict on one mutant, and what the promise about files without errors is worth on it."""
    from nao_kin.checks.checker import check, check_bytes
    from nao_kin.urdf.xacro import expand_xacro

    if source.suffix == ".xml":
        return _mjcf_verdict(data)
    start = time.process_time()
    if source.suffix == ".xacro":
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "mutant.urdf.xacro"
            path.write_bytes(data)
            report = check(path, arguments={"name": "ur5e"})
            data = b"" if report.errors else expand_xacro(path, {"name": "ur5e"}).data
    else:
        report = check_bytes(data, "mutant.urdf")
    seconds = time.process_time() - start
    verdict = {"seconds": seconds, "codes": list(report.codes), "errors": len(report.errors), "broken": ""}
    if not report.errors:
        say({"checked": True})  # so that a crash from here on is known to be Pinocchio's
        verdict["broken"] = _broken_promise(data, seed, compared)
    return verdict


def _mjcf_verdict(data: bytes) -> dict[str, Any]:
    """A mutant of an MJCF file loads with finite poses, or is refused."""
    import warnings

    import numpy as np

    from nao_kin.errors import NaoKinError
    from nao_kin.robot.robot import load

    start, broken, codes = time.process_time(), "", []
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        path = Path(folder) / "mutant.xml"
        path.write_bytes(data)
        try:
            poses = load(path).link_poses({})
        except NaoKinError as refusal:
            codes = [getattr(refusal, "code", "refused")]
        else:
            if not all(np.isfinite(pose.homogeneous).all() for pose in poses.values()):
                broken = "a pose is not finite"
    return {"seconds": time.process_time() - start, "codes": codes, "errors": len(codes), "broken": broken}


def _broken_promise(data: bytes, seed: int, compared: bool) -> str:
    import numpy as np
    import pinocchio as pin

    try:
        model = pin.buildModelFromXML(data.decode("utf-8-sig"))
    except ValueError as error:
        return f"Pinocchio refuses it: {error}"
    scratch, rng = model.createData(), np.random.default_rng(seed)
    lower, upper = np.maximum(model.lowerPositionLimit, -3.0), np.minimum(model.upperPositionLimit, 3.0)
    configurations = [pin.neutral(model), *(_random(pin, model, lower, upper, rng) for _ in range(3))]
    for q in configurations:
        pin.framesForwardKinematics(model, scratch, q)
        if not all(np.isfinite(frame.homogeneous).all() for frame in scratch.oMf):
            return "a pose is not finite"
    return _disagreement(data) if compared else ""


def _random(pin: Any, model: Any, lower: Any, upper: Any, rng: Any) -> Any:
    q = lower + (upper - lower) * rng.random(model.nq)
    return pin.normalize(model, q)


def _disagreement(data: bytes) -> str:
    from nao_kin.checks.checker import check_bytes

    report = check_bytes(data, "mutant.urdf", thorough=True, select=["readers-disagree"])
    return "; ".join(finding.message for finding in report)


def say(data: dict[str, Any]) -> None:
    """One line to the parent process."""
    print(json.dumps(data), flush=True)


def work(first: int, last: int, seed: int) -> None:
    """What a guarded process does: a line a mutant."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    # urdfdom writes its complaints to the C stream.
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
    files = sources()
    for number in range(first, last):
        say({"number": number})
        source, data = mutant_of(number, seed, files)
        compared = number % COMPARED == 0
        say({"source": source.name, **examine(source, data, number, compared), "compared": compared})


@dataclass
class Outcome:
    """What all mutants together have shown."""

    done: int = 0
    clean: int = 0
    compared: int = 0
    slowest: float = 0.0
    codes: Counter[str] = field(default_factory=Counter)
    broken: list[str] = field(default_factory=list)

    def take(self, number: int, verdict: dict[str, Any]) -> None:
        """Counts one verdict in."""
        self.done += 1
        self.slowest = max(self.slowest, verdict["seconds"])
        self.codes.update(verdict["codes"])
        if not verdict["errors"]:
            self.clean += 1
            self.compared += verdict["compared"]
        if verdict["broken"]:
            self.broken.append(f"mutant {number} of {verdict['source']}: {verdict['broken']} {verdict['codes']}")
        if verdict["seconds"] > SECONDS:
            self.broken.append(f"mutant {number} of {verdict['source']}: {verdict['seconds']:.1f} s")


def guarded(first: int, last: int, seed: int, outcome: Outcome) -> None:
    """A batch in processes of its own; after a crash or a hang the next process goes on behind the culprit."""
    while first < last:
        command = [sys.executable, __file__, "--work", str(first), str(last), "--seed", str(seed)]
        number, checked, finished = first, False, False
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            for line in _lines(process):
                data = json.loads(line)
                if "number" in data:
                    number, checked, finished = data["number"], False, False
                elif "checked" in data:
                    checked = True
                else:
                    finished = True
                    outcome.take(number, data)
        if process.returncode == 0:
            return
        where = "Pinocchio, after a check without errors" if checked else "the check"
        if not finished:
            outcome.done += 1
            outcome.broken.append(f"mutant {number}: {where} ended the process with {process.returncode}")
        first = number + 1


def _lines(process: subprocess.Popen[str]) -> Iterator[str]:
    """Lines as they come; a process that says nothing for too long is ended."""
    import selectors

    assert process.stdout is not None  # noqa: S101
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ)
        while selector.select(HANG):
            line = process.stdout.readline()
            if not line:
                return
            yield line
    process.kill()


def keep(number: int, seed: int) -> Path:
    """The mutant of that number, written to a file to look at."""
    path = Path(tempfile.gettempdir()) / f"mutant_{seed}_{number}.urdf"
    path.write_bytes(mutant_of(number, seed, sources())[1])
    return path


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mutants", type=int, default=20_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first mutant")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=int, metavar="NUMBER", help="write this mutant to a file and stop")
    parser.add_argument("--work", type=int, nargs=2, metavar=("FIRST", "LAST"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.work:
        work(arguments.work[0], arguments.work[1], arguments.seed)
        return 0
    if arguments.keep is not None:
        print(keep(arguments.keep, arguments.seed))
        return 0
    outcome, end = Outcome(), arguments.first + arguments.mutants
    for first in range(arguments.first, end, BATCH):
        guarded(first, min(first + BATCH, end), arguments.seed, outcome)
        if sys.stderr.isatty():
            print(f"\r{outcome.done} mutants, {len(outcome.broken)} broken promises", end="", file=sys.stderr)
    print(f"mutants                       {outcome.done}")
    print(f"without errors                {outcome.clean}, of these by yourdfpy too {outcome.compared}")
    print(f"slowest check                 {outcome.slowest:.2f} s")
    print(f"codes that occurred           {len(outcome.codes)}")
    print(f"broken promises               {len(outcome.broken)}")
    for line in outcome.broken[:50]:
        print(f"  {line}")
    return 1 if outcome.broken or outcome.done < arguments.mutants else 0


if __name__ == "__main__":
    sys.exit(main())
