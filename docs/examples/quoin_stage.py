"""A Quoin stage in Python: the contract (docs/stages.md) and the artifacts (docs/artifacts.md), with numpy alone.

A stage declares itself and gives a function from its inputs to its outputs:

    STAGE = {"name": "flip", "summary": "...", "impl_version": 1,
             "inputs": [port("mesh", "...")], "outputs": [port("mesh", "...")],
             "params": [param("axis", "int", 0, "which axis", min=0, max=2)]}

    if __name__ == "__main__":
        run(STAGE, lambda inputs, params: {"mesh": flip(inputs["mesh"], params["axis"])})

Keys, the store and the record are Quoin's business: it runs the program with the content of its files in the key.
"""
import difflib
import json
import math
import os
import sys

import numpy as np

TYPES = {"U8": "u1", "I8": "i1", "U16": "<u2", "I16": "<i2", "U32": "<u4", "I32": "<i4", "F32": "<f4", "F64": "<f8",
         "U64": "<u8", "I64": "<i8"}
EXIT_CODES = {"0": "done", "2": "usage or configuration", "3": "bad input data", "5": "cannot succeed on this data"}
OPTIONS = ["--threads", "--memory", "--progress", "--log-level", "--cache", "--store", "--record"]  # taken, not needed


class UsageError(Exception):
    """The command line is wrong: exit code 2."""


class InputError(Exception):
    """The data is wrong: exit code 3."""


def port(name, doc, optional=False, schema=None):
    return {"port": name, "schema": schema or name, "version": 1, "optional": optional, "doc": doc}


def param(name, kind, default, doc, unit="", affects_result=True, **bounds):
    return {"name": name, "type": kind, "default": default, "unit": unit, "doc": doc, **bounds,
            "affects_result": affects_result}


def read_artifact(path, schema):
    """Named arrays of a safetensors file whose schema is `schema`."""
    try:
        with open(path, "rb") as file:
            raw = file.read()
    except OSError as error:
        raise InputError(f"{path}: cannot read: {error.strerror}")
    try:
        length = int.from_bytes(raw[:8], "little")
        header = json.loads(raw[8:8 + length])
        found = header.pop("__metadata__")["quoin.schema"]
        data = memoryview(raw)[8 + length:]
        tensors = {name: np.frombuffer(data[slice(*entry["data_offsets"])], TYPES[entry["dtype"]]).reshape(entry["shape"])
                   for name, entry in header.items()}
    except (ValueError, KeyError, TypeError, AttributeError):
        raise InputError(f"{path}: not a whole Quoin artifact (safetensors)")
    if found != schema:
        raise InputError(f"{path}: holds a '{found}'; expected a '{schema}'")
    return tensors


def write_artifact(path, schema, tensors):
    """Writes a safetensors file whole or not at all: tensors by falling element size, then name; header padded to 64."""
    names = {np.dtype(code).str: name for name, code in TYPES.items()}
    arrays = {name: np.ascontiguousarray(array) for name, array in tensors.items()}
    order = sorted(arrays, key=lambda name: (-arrays[name].itemsize, name))
    header, offset = {"__metadata__": {"quoin.schema": schema, "quoin.schema_version": "1"}}, 0
    for name in order:
        end = offset + arrays[name].nbytes
        header[name] = {"dtype": names[arrays[name].dtype.str], "shape": list(arrays[name].shape),
                        "data_offsets": [offset, end]}
        offset = end
    text = json.dumps(header, separators=(",", ":")).encode()
    text += b" " * (-(len(text) + 8) % 64)
    temporary = f"{path}.{os.getpid()}.tmp"
    try:
        with open(temporary, "wb") as file:
            file.write(len(text).to_bytes(8, "little") + text)
            for name in order:
                file.write(arrays[name].tobytes())
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as error:
        raise InputError(f"{path}: cannot write: {error.strerror}")
    finally:
        if os.path.exists(temporary):
            os.remove(temporary)


def hint(name, names):
    near = difflib.get_close_matches(name, names, 1)
    return f"; did you mean '{near[0]}'?" if near else f"; there is: {', '.join(names)}"


def parse_value(spec, text):
    """A parameter's text as its type, or UsageError saying what was expected."""
    wrong = UsageError(f"--set: parameter '{spec['name']}' is '{text}': expected ")
    try:
        if spec["type"] == "bool":
            return {"true": True, "false": False}[text]
        if spec["type"] in ("string", "choice"):
            if text not in spec.get("choices", [text]):
                raise ValueError
            return text
        value = int(text) if spec["type"] == "int" else float(text)
        if not math.isfinite(value) or not spec.get("min", value) <= value <= spec.get("max", value):
            raise ValueError
        return value
    except (ValueError, KeyError):
        interval = f" from {spec.get('min', '-inf')} to {spec.get('max', 'inf')}" if "min" in spec or "max" in spec else ""
        wrong.args = (wrong.args[0] + f"a {spec['type']}{interval} {' | '.join(spec.get('choices', []))}".rstrip(),)
        raise wrong from None


def named(flag, text, names, what):
    """NAME and VALUE of NAME=VALUE, the name being one of `names`."""
    name, equals, value = text.partition("=")
    if not equals:
        raise UsageError(f"{flag} {text}: expected NAME=VALUE")
    if name not in names:
        raise UsageError(f"{flag} {text}: there is no {what} '{name}'{hint(name, names)}")
    return name, value


def parse_arguments(stage, words):
    inputs, outputs = {}, {}
    specs = {spec["name"]: spec for spec in stage["params"]}
    params = {name: spec["default"] for name, spec in specs.items()}
    words = iter(words)
    for flag in words:
        value = next(words, None)
        if flag not in ["--in", "--out", "--set", "--scan-root", *OPTIONS]:
            raise UsageError(f"there is no option '{flag}'{hint(flag, ['--in', '--out', '--set', '--scan-root', *OPTIONS])}")
        if value is None:
            raise UsageError(f"{flag}: a value is missing")
        if flag == "--in":
            name, inputs_path = named(flag, value, [p["port"] for p in stage["inputs"]], "port")
            inputs[name] = inputs_path
        elif flag == "--out":
            name, outputs_path = named(flag, value, [p["port"] for p in stage["outputs"]], "port")
            outputs[name] = outputs_path
        elif flag == "--set":
            name, text = named(flag, value, list(specs), "parameter")
            params[name] = parse_value(specs[name], text)
    for p in stage["inputs"]:
        if not p["optional"] and p["port"] not in inputs:
            raise UsageError(f"input '{p['port']}' is missing: add --in {p['port']}=PATH")
    if not outputs:
        raise UsageError(f"no output: add --out {stage['outputs'][0]['port']}=PATH")
    return inputs, outputs, params


def run(stage, function):
    """Answers --describe, or runs function(inputs, params) -> outputs on artifacts as dictionaries of arrays."""
    words = sys.argv[1:]
    if words == ["--describe"]:
        code = [os.path.basename(__file__)]  # this file is a part of the stage, too
        print(json.dumps({**stage, "deterministic": True, "code": code, "exit_codes": EXIT_CODES}, indent=2))
        return
    try:
        inputs, outputs, params = parse_arguments(stage, words)
        schemas = {p["port"]: p["schema"] for p in stage["inputs"] + stage["outputs"]}
        results = function({name: read_artifact(path, schemas[name]) for name, path in inputs.items()}, params)
        for name, path in outputs.items():
            write_artifact(path, schemas[name], results[name])
    except (UsageError, InputError) as error:
        print(f"{stage['name']}: error: {error}", file=sys.stderr)
        sys.exit(2 if isinstance(error, UsageError) else 3)
