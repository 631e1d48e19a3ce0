"""The cache of compiled functions: announced once, silent when warm, never stale, never a reason to fail."""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import nao_kin
from nao_kin.kernels import compiling, forward
from tests.kernels.paths import random_path

PATH = """
import numpy as np
from nao_kin.kernels import audit, forward
from nao_kin.kernels.joint_path import PathJoint, joint_path
T = np.eye(4)
T[0, 3] = 0.5
joints = [PathJoint(T, np.array([0.0, 0.0, 1.0]), False, k) for k in range(2)]
path = joint_path(joints, T, np.full(2, -np.inf), np.full(2, np.inf))
Q = np.zeros((100, 2))
"""
PROBE = """
from nao_kin.kernels.probe import doubled, doubled_all
import numpy as np
x = np.ones(3)
doubled_all(x)
print(doubled(1.0), x[0])
"""
ANNOUNCEMENT = "nao_kin: compiling kernels"


def run(code: str, home: Path, **environment: str) -> tuple[str, str]:
    """Standard output and error of a program with a cache folder of its own."""
    env = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA_", "XDG_", "PYTHONWARNINGS"))}
    env |= {"XDG_CACHE_HOME": str(home), **environment}
    done = subprocess.run(
        [sys.executable, "-c", code], env=env, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip(), done.stderr


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package with two compiled functions, quick to compile, one with a helper in another module."""
    folder = tmp_path_factory.mktemp("sources")
    shutil.copytree(Path(nao_kin.__file__).parent, folder / "nao_kin", ignore=shutil.ignore_patterns("__pycache__"))
    kernels = folder / "nao_kin" / "kernels"
    (kernels / "probe_helper.py").write_text(
        "from nao_kin.kernels.compiling import jit\n\n\n@jit\ndef factor(x):\n    return 2.0\n"
    )
    (kernels / "probe.py").write_text(
        "from nao_kin.kernels.compiling import jit, parallel_jit, prange\n"
        "from nao_kin.kernels.probe_helper import factor\n\n\n"
        "@jit\ndef doubled(x):\n    return factor(x) * x\n\n\n"
        "@parallel_jit\ndef doubled_all(x):\n    for i in prange(x.size):\n        x[i] *= factor(x[i])\n"
    )
    return folder


def probe(sources: Path, home: Path, **environment: str) -> tuple[str, str]:
    return run(PROBE, home, PYTHONPATH=str(sources), PYTHONDONTWRITEBYTECODE="1", **environment)


def test_the_real_kernels_are_announced_once_and_load_in_silence(tmp_path: Path) -> None:
    code = (
        PATH
        + "print(forward.poses(path, Q)[0, 0, 3], forward.jacobians(path, Q)[0, 1, 0], audit.tips(path, Q)[0, 0, 3])"
    )
    cold = run(code, tmp_path)
    assert cold[0] == "1.5 1.0 1.5"
    assert cold[1].count("\n") == 1
    assert cold[1].startswith(ANNOUNCEMENT)
    assert "once" in cold[1]
    assert run(code, tmp_path) == (cold[0], "")
    assert list((tmp_path / "nao_kin" / "kernels").glob("*/parallel/**/*.nbc"))


def test_importing_compiles_nothing_and_says_nothing(tmp_path: Path) -> None:
    code = PATH + "from nao_kin.kernels.motion import place as f\nprint(len(f.signatures))"
    assert run(code, tmp_path) == ("0", "")


def test_without_a_folder_everything_works_with_one_warning(sources: Path, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    out, err = probe(sources, tmp_path / "file" / "cache")
    assert out == "2.0 2.0"
    assert err.count("KernelCacheWarning") == 1
    assert err.count(ANNOUNCEMENT) == 1
    assert "every process" in err


def test_numba_cache_dir_is_the_parent(sources: Path, tmp_path: Path) -> None:
    assert probe(sources, tmp_path / "xdg", NUMBA_CACHE_DIR=str(tmp_path / "numba"))[0] == "2.0 2.0"
    assert list((tmp_path / "numba" / "nao_kin").glob("*/serial/**/*.nbc"))
    assert not (tmp_path / "xdg").exists()
    assert probe(sources, tmp_path / "xdg", NUMBA_CACHE_DIR=str(tmp_path / "numba")) == ("2.0 2.0", "")


def test_a_relative_cache_home_is_ignored(sources: Path, tmp_path: Path) -> None:
    assert probe(sources, Path("relative"), HOME=str(tmp_path))[0] == "2.0 2.0"
    assert (tmp_path / ".cache" / "nao_kin" / "kernels").is_dir()


def test_a_changed_helper_is_compiled_anew(sources: Path, tmp_path: Path) -> None:
    helper = sources / "nao_kin" / "kernels" / "probe_helper.py"
    before = helper.read_text()
    assert probe(sources, tmp_path)[0] == "2.0 2.0"
    helper.write_text(before.replace("2.0", "3.0"))
    out, err = probe(sources, tmp_path)
    assert out == "3.0 3.0"
    assert ANNOUNCEMENT in err
    helper.write_text(before)
    assert probe(sources, tmp_path) == ("2.0 2.0", "")


@pytest.mark.parametrize("suffix", ["nbi", "nbc"])
def test_damaged_files_count_as_missing(sources: Path, tmp_path: Path, suffix: str) -> None:
    probe(sources, tmp_path)
    for file in tmp_path.rglob(f"*.{suffix}"):
        file.write_bytes(file.read_bytes()[:20])
    out, err = probe(sources, tmp_path)
    assert out == "2.0 2.0"
    assert err.count("\n") == 1
    assert err.startswith(ANNOUNCEMENT)
    assert probe(sources, tmp_path) == ("2.0 2.0", "")


def test_a_full_disk_costs_no_answer() -> None:
    class Cache:
        def load_overload(self):
            raise EOFError

        def save_overload(self):
            raise OSError(28, "No space left on device")

        def flush(self):
            raise OSError(28, "No space left on device")

    class Dispatcher:
        _cache = Cache()

    compiling._forgive_damage(Dispatcher)
    assert Dispatcher._cache.load_overload() is None
    assert Dispatcher._cache.save_overload() is None


def test_other_packages_cache_where_they_always_did(tmp_path: Path) -> None:
    (tmp_path / "other.py").write_text("import numba\n\n\n@numba.njit(cache=True)\ndef f(x):\n    return x\n")
    code = f"""
import sys
sys.path.insert(0, {str(tmp_path)!r})
from nao_kin.kernels import forward
import numba, other
print(other.f(1), other.f.stats.cache_path, repr(numba.config.CACHE_DIR), repr(numba.config.CACHE_LOCATOR_CLASSES))
"""
    out, err = run(code, tmp_path / "cache")
    assert out == f"1 {tmp_path / '__pycache__'} '' ''"
    assert not err  # what others compile is not announced


def test_a_forked_child_computes_the_same(tmp_path: Path) -> None:
    code = (
        PATH
        + """
import multiprocessing, warnings
warnings.simplefilter("ignore", DeprecationWarning)  # newer Pythons warn of forking at all
expected = forward.poses(path, Q)
with multiprocessing.get_context("fork").Pool(2) as pool:
    results = pool.starmap(forward.poses, [(path, Q)] * 4)
print(all((result == expected).all() for result in results))
"""
    )
    assert run(code, tmp_path)[0] == "True"


def test_threads_take_turns(rng: np.random.Generator) -> None:
    path, Q = random_path(rng), rng.uniform(-3, 3, (2000, 6))
    expected = forward.poses(path, Q)
    with ThreadPoolExecutor(8) as pool:
        for result in pool.map(lambda _: forward.poses(path, Q), range(64)):
            np.testing.assert_array_equal(result, expected)


def test_without_numba_s_compiler_the_kernels_run_as_python(tmp_path: Path) -> None:
    code = PATH + "print(forward.poses(path, Q[:1])[0, 0, 3], forward.jacobians(path, Q[:1])[0, 1, 0])"
    assert run(code, tmp_path, NUMBA_DISABLE_JIT="1") == ("1.5 1.0", "")


def test_pruning_spares_what_is_in_use_and_what_is_not_ours(tmp_path: Path) -> None:
    for name in ("0" * 20, "1" * 20, "0" * 19, "notes"):
        (tmp_path / name).mkdir()
    (tmp_path / ("2" * 20)).symlink_to(tmp_path / "notes")
    long_ago = time.time() - 100 * 86400
    for name in ("0" * 20, "0" * 19, "notes"):
        os.utime(tmp_path / name, (long_ago, long_ago))
    compiling._prune(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(["1" * 20, "0" * 19, "notes", "2" * 20])


def test_the_digest_sees_names_and_contents(tmp_path: Path) -> None:
    a, b = tmp_path / "a.py", tmp_path / "b.py"
    a.write_text("x"), b.write_text("y")
    first = compiling.source_digest([a, b])
    assert compiling.source_digest([b, a]) == first
    assert compiling.source_digest([a]) != first
    a.write_text("y"), b.write_text("x")
    assert compiling.source_digest([a, b]) != first


def compiled_files() -> set[Path]:
    """Every file of the package that holds a compiled function, by its decorators."""
    found = set()
    for path in Path(nao_kin.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef) and any(
                ast.unparse(decorator).rpartition(".")[2] in {"jit", "leaf_jit", "parallel_jit"}
                for decorator in node.decorator_list
            ):
                found.add(path)
    return found


def test_the_digest_covers_every_file_with_a_compiled_function() -> None:
    files = compiled_files()
    assert len(files) >= 25
    assert any(len(path.relative_to(Path(nao_kin.__file__).parent).parts) > 2 for path in files)  # in subfolders too
    assert files <= set(compiling._sources())


def test_a_changed_or_moved_file_in_a_subfolder_changes_the_digest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compiling, "_PACKAGE", tmp_path)
    deep, beside = tmp_path / "ik" / "deep" / "helper.py", tmp_path / "ik" / "beside" / "helper.py"
    deep.parent.mkdir(parents=True)
    deep.write_text("FACTOR = 2.0\n")
    digests = [compiling.source_digest(compiling._sources())]
    deep.write_text("FACTOR = 3.0\n")
    digests.append(compiling.source_digest(compiling._sources()))
    beside.parent.mkdir()
    deep.rename(beside)
    digests.append(compiling.source_digest(compiling._sources()))
    assert len(set(digests)) == 3
