"""What tells one function of a question from another."""

from __future__ import annotations

import functools
import hashlib
import types
from collections.abc import Iterable
from typing import Any

from elbowroom.errors import ArgumentError


def name_of(function: Any) -> str:
    """Return the name of a function, and a hash of what it does: its code, the values that it encloses, and its defaults.

    Functions that it calls, and other global names, are not looked into.

    Raises
    ------
    ArgumentError
        If it is not a function, or one of its values cannot be told from others.
    """
    name = getattr(function, "__qualname__", type(function).__name__)
    content = hashlib.sha256(repr(list(_parts(function))).encode()).hexdigest()
    return f"{name} {content[:32]}"


def _parts(value: Any) -> Iterable[str]:
    """Return words that differ if functions do."""
    if isinstance(value, functools.partial):
        yield from _parts(value.func)
        for other in (*value.args, *sorted(value.keywords.items())):
            yield from _parts(other)
    elif isinstance(value, types.FunctionType):
        yield from _code(value.__code__)
        for other in (*(value.__defaults__ or ()), *sorted((value.__kwdefaults__ or {}).items())):
            yield from _parts(other)
        for cell in value.__closure__ or ():
            yield from _parts(cell.cell_contents)
    else:
        yield _word(value)


def _code(code: types.CodeType) -> Iterable[str]:
    yield from (code.co_code.hex(), repr(code.co_names), repr(code.co_varnames))
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _code(constant)
        else:
            yield repr(constant)


def _word(value: Any) -> str:
    data = getattr(value, "tobytes", None)
    if data is not None:
        return f"{getattr(value, 'dtype', '')} {getattr(value, 'shape', '')} {hashlib.sha256(data()).hexdigest()}"
    word = repr(value)
    if " at 0x" in word:
        text = f"nothing tells {word} from others of its kind\n  write: a function whose values are numbers, texts, tuples or arrays"
        raise ArgumentError(text)
    return word
