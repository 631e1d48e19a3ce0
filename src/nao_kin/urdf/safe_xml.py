"""From hostile bytes to an element tree, or to a refusal with a line.

Whatever can be decided on the bytes (size, encoding, DOCTYPE, amount of markup) is decided before the XML parser sees
them, so that the parser's time and memory are bounded too.
"""

from __future__ import annotations

import re

from lxml import etree

from nao_kin.errors import UrdfError
from nao_kin.urdf.foreign import declared
from nao_kin.urdf.size_limits import LIMITS

__all__ = ["read_tree"]

_BYTE_ORDER_MARKS = {
    b"\xff\xfe\x00\x00": "UTF-32",
    b"\x00\x00\xfe\xff": "UTF-32",
    b"\xff\xfe": "UTF-16",
    b"\xfe\xff": "UTF-16",
}
_UTF8_NAMES = {"utf-8", "utf8", "us-ascii", "ascii"}
_UTF8_MARK = b"\xef\xbb\xbf"

# What may stand before a DOCTYPE: blanks, comments and processing instructions. The XML declaration is one of the
# latter as far as this pattern cares. The possessive quantifiers keep it linear on whatever it is given.
_PROLOG = re.compile(rb"(?:[ \t\r\n]++|<!--.*?-->|<\?.*?\?>)*+", re.DOTALL)
_DECLARED_ENCODING = re.compile(rb"<\?xml\s[^>]{0,200}?encoding\s*=\s*[\"']([^\"'>]{1,40})[\"']")

_ENCODING_HINT = "Save the file as UTF-8."
_UNDECLARED = re.compile(r"Namespace prefix (\S{1,64}) (?:for \S+ )?on \S+ is not defined")
_PREFIX = re.compile(r"[A-Za-z_][A-Za-z0-9_.-]*")
_MOST_UNDECLARED = 10_000  # uses of such prefixes; one message each


def read_tree(data: bytes, path: str) -> etree._Element:
    """Parse untrusted XML with entities, network, DTD and huge trees off.

    Args:
        data: The whole file.
        path: How messages name the file.

    Returns:
        The root element; comments and processing instructions are gone.

    Raises:
        UrdfError: The bytes are too many, not UTF-8, not well-formed, declare a DOCTYPE, or exceed a bound of
            `ReadLimits`.
    """
    _check_size(data, path)
    _check_encoding(data, path)
    _check_prolog(data, path)
    _check_amount(data, path)
    root = _parse(data, path)
    if root.getroottree().docinfo.internalDTD is not None:  # a second lock behind _check_prolog
        raise _doctype_error(path, None)
    _check_nesting(root, path)
    return root


def _check_size(data: bytes, path: str) -> None:
    if len(data) > LIMITS.file_bytes:
        reason = f"The file has {len(data)} bytes; at most {LIMITS.file_bytes} are read."
        raise UrdfError(path, None, reason, code="too-large")
    if not data.strip():
        raise UrdfError(path, None, "The file is empty.", code="empty-file")


def _check_encoding(data: bytes, path: str) -> None:
    for mark, name in _BYTE_ORDER_MARKS.items():
        if data.startswith(mark):
            reason = f"The file is encoded in {name}, not in UTF-8."
            raise UrdfError(path, 1, reason, _ENCODING_HINT, code="not-utf8")
    nul = data.find(b"\x00")
    if nul >= 0:
        reason = "The file contains a NUL byte, so it is not UTF-8 text."
        raise UrdfError(path, _line_at(data, nul), reason, _ENCODING_HINT, code="not-utf8")
    declared = _DECLARED_ENCODING.match(data.removeprefix(_UTF8_MARK)[:512])
    if declared and declared[1].decode("ascii", "replace").lower() not in _UTF8_NAMES:
        name = declared[1].decode("ascii", "replace")
        reason = f"The file declares the encoding {name!r}; only UTF-8 is read."
        raise UrdfError(path, 1, reason, _ENCODING_HINT, code="not-utf8")


def _check_prolog(data: bytes, path: str) -> None:
    # XML allows a DOCTYPE only here; anywhere else the parser itself reports it as not well-formed.
    end = _root_start(data)
    if data[end : end + 9].upper() == b"<!DOCTYPE":
        raise _doctype_error(path, _line_at(data, end))


def _root_start(data: bytes) -> int:
    """Where the root element or a DOCTYPE begins."""
    start = len(_UTF8_MARK) if data.startswith(_UTF8_MARK) else 0
    prolog = _PROLOG.match(data, start)
    return prolog.end() if prolog else start


def _doctype_error(path: str, line: int | None) -> UrdfError:
    hint = "Remove the DOCTYPE and write out its entities; a URDF needs neither."
    reason = "The file declares a DOCTYPE, through which XML can reach other files."
    return UrdfError(path, line, reason, hint, code="doctype")


def _check_amount(data: bytes, path: str) -> None:
    for sign, most, what in ((b"<", LIMITS.markup, "tags"), (b"=", LIMITS.attributes, "attributes")):
        if data.count(sign) > most:
            raise UrdfError(path, None, f"The file holds more than {most} {what}.", code="too-large")
    if data.count(b"\n") > LIMITS.lines:
        raise UrdfError(path, None, f"The file has more than {LIMITS.lines} lines.", code="too-large")


def _parse(data: bytes, path: str, *, may_declare: bool = True) -> etree._Element:
    parser = etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        dtd_validation=False,
        attribute_defaults=False,
        huge_tree=False,
        recover=False,
        remove_comments=True,
        remove_pis=True,
        encoding="utf-8",
    )
    try:
        return etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        prefixes = _undeclared(parser) if may_declare else []
        if not prefixes:
            raise _syntax_error(error, path) from None
    # Only its prefixes are amiss, past which every reader of URDF gets.
    return _parse(declared(data, _root_start(data), prefixes), path, may_declare=False)


def _undeclared(parser: etree.XMLParser) -> list[str]:
    """The prefixes that nothing declares, if that is all that is wrong with a file."""
    # The log of the error itself holds what other files have said before.
    found = [_UNDECLARED.match(entry.message) for entry in parser.error_log]
    if not found or not all(found) or len(found) > _MOST_UNDECLARED:
        return []
    prefixes = {name[1] for name in found if name}
    return sorted(prefixes) if all(map(_PREFIX.fullmatch, prefixes)) else []


def _syntax_error(error: etree.XMLSyntaxError, path: str) -> UrdfError:
    line = error.lineno or None
    # libxml2 ends its messages with the position, which the error carries already.
    said = re.sub(r"\s*,?\s*line \d+, column \d+\s*$", "", error.msg or "").strip()
    said = re.sub(r"\s+", " ", "".join(c if c.isprintable() else " " for c in said))[:200].rstrip(".")
    if "Excessive depth" in said:
        reason = f"Elements are nested deeper than {LIMITS.depth} levels."
        return UrdfError(path, line, reason, code="too-deep")
    if "XML_PARSE_HUGE" in said or "too long" in said.lower():
        reason = "A name, value or text is longer than the XML parser reads."
        return UrdfError(path, line, reason, code="too-large")
    if "UTF-8" in said or "encoding" in said:
        return UrdfError(path, line, "The file is not UTF-8 text.", _ENCODING_HINT, code="not-utf8")
    return UrdfError(path, line, f"The file is not well-formed XML: {said}.", code="not-well-formed")


def _check_nesting(root: etree._Element, path: str) -> None:
    depth = 0
    for event, element in etree.iterwalk(root, events=("start", "end")):
        if event == "end":
            depth -= 1
            continue
        depth += 1
        if depth > LIMITS.depth:
            reason = f"Elements are nested deeper than {LIMITS.depth} levels."
            raise UrdfError(path, element.sourceline, reason, code="too-deep")
        if len(element.attrib) > LIMITS.attributes_per_element:
            reason = f"An element has more than {LIMITS.attributes_per_element} attributes."
            raise UrdfError(path, element.sourceline, reason, code="too-large")
        for name, value in element.attrib.items():
            if len(value) > LIMITS.value_characters:
                reason = f"The attribute {str(name)[:40]!r} has more than {LIMITS.value_characters} characters."
                raise UrdfError(path, element.sourceline, reason, code="too-large")


def _line_at(data: bytes, offset: int) -> int:
    return data.count(b"\n", 0, offset) + 1
