"""Functions in MATLAB's language as a model: by MATLAB where its Engine for Python is installed, else by GNU Octave.

    from lss_model.matlab import Matlab

    matlab = Matlab("folder of the .m files")
    temperature = matlab.call("oven", time, power, {"loss": 5})

A list or an array is a column, a number a scalar and a dictionary a struct, in whose names each character that MATLAB does
not allow becomes `_`: `radiation.area` is `p.radiation_area`. One numeric array is answered, as a list in MATLAB's order.

The program is started once and kept; one process is one licence of MATLAB, so give `--jobs` as many as there are.
LSS_MATLAB chooses: `matlab`, `octave`, or the command that starts Octave.
"""
import atexit
import importlib.util
import os
import re
import shutil
import subprocess
import sys

__all__ = ["Matlab"]


def Matlab(folder):
    """MATLAB or Octave, with `folder` in its path."""
    chosen = os.environ.get("LSS_MATLAB", "")
    folder = os.path.abspath(folder)
    if chosen == "matlab" or not chosen and importlib.util.find_spec("matlab") and importlib.util.find_spec("matlab.engine"):
        return _Engine(folder)
    program = shutil.which("octave-cli" if chosen in ("", "octave") else chosen)
    if program is None:
        sys.exit("lss_model.matlab: neither the MATLAB Engine for Python nor octave-cli is installed")
    return _Octave(program, folder)


def _field(name):
    return re.sub(r"\W", "_", name)


def _list(values):
    return [float(x) for x in (values.tolist() if hasattr(values, "tolist") else values)]


class _Engine:
    def __init__(self, folder):
        import matlab
        import matlab.engine

        self.matlab, self.engine = matlab, matlab.engine.start_matlab()
        self.engine.addpath(folder, nargout=0)
        atexit.register(self.engine.quit)

    def call(self, function, *values):
        answer = getattr(self.engine, function)(*map(self._value, values))
        if isinstance(answer, (int, float)):
            return [float(answer)]
        # MATLAB's order goes down the columns.
        return [float(x) for column in zip(*answer) for x in column]

    def _value(self, value):
        if isinstance(value, dict):
            return {_field(name): self._value(x) for name, x in value.items()}
        if isinstance(value, (int, float)):
            return float(value)
        return self.matlab.double([[x] for x in _list(value)])


# Written before and after what Octave answers, so that what a function prints is no answer.
_BEGIN, _END, _FAILED = "lss-model-begin", "lss-model-end", "lss-model-failed"


class _Octave:
    def __init__(self, program, folder):
        self.octave = subprocess.Popen(
            [program, "--quiet", "--no-init-file", "--no-history", "--path", folder],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        atexit.register(self._quit)

    def _quit(self):
        self.octave.stdin.close()
        self.octave.kill()
        self.octave.wait()

    def call(self, function, *values):
        if not re.fullmatch(r"[A-Za-z]\w*", function):
            raise ValueError(f"{function} is no name of a function")
        given = "".join(self._assign(f"lss_x{k}", value) for k, value in enumerate(values))
        names = ", ".join(f"lss_x{k}" for k in range(len(values)))
        self.octave.stdin.write(
            f"{given}try\nlss_y = double({function}({names}));\n"
            f"printf('\\n{_BEGIN}\\n%s{_END}\\n', sprintf('%.17g\\n', lss_y));\n"
            f"catch lss_why\nprintf('\\n{_FAILED}\\n%s\\n{_END}\\n', lss_why.message);\nend_try_catch\nfflush(stdout);\n"
        )
        self.octave.stdin.flush()
        kind, answer = None, []
        for line in self.octave.stdout:
            line = line.rstrip("\n")
            if kind is None and line in (_BEGIN, _FAILED):
                kind = line
            elif kind is None:
                if line:
                    print(line, file=sys.stderr)
            elif line == _END:
                break
            else:
                answer.append(line)
        else:
            raise RuntimeError("Octave ended instead of answering")
        if kind == _FAILED:
            raise RuntimeError(" ".join(answer))
        return [float(x) for x in answer if x]

    def _assign(self, name, value):
        if isinstance(value, dict):
            return f"{name} = struct();\n" + "".join(self._assign(f"{name}.{_field(n)}", x) for n, x in value.items())
        if isinstance(value, (int, float)):
            return f"{name} = {float(value)!r};\n"
        return f"{name} = [" + ";".join(map(repr, _list(value))) + "];\n"
