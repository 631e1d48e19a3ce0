"""Bytes that attack the XML parser: each is refused with a line, and none is ever followed, fetched or expanded."""

from __future__ import annotations

import pytest

from nao_kin.errors import UrdfError
from nao_kin.urdf import LIMITS, parse_urdf

MINIMAL = b'<robot name="r">\n<link name="a"/>\n</robot>'

BOMB = b"<!DOCTYPE robot [\n" + b'<!ENTITY a "ha">\n' + b'<!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">\n' * 20 + b"]>\n"
XXE = b'<!DOCTYPE robot [<!ENTITY secret SYSTEM "file:///etc/passwd">]>\n'
EXTERNAL_DTD = b'<!DOCTYPE robot SYSTEM "http://127.0.0.1:9/evil.dtd">\n'
PARAMETER_ENTITY = b'<!DOCTYPE robot [<!ENTITY % x SYSTEM "file:///dev/zero"> %x;]>\n'

REFUSED = {
    "empty": (b"", None, "empty"),
    "blank": (b" \n\n\t", None, "empty"),
    "entity bomb": (b"<?xml version='1.0'?>\n\n" + BOMB + MINIMAL, 3, "DOCTYPE"),
    "external entity": (XXE + b'<robot name="&secret;"/>', 1, "DOCTYPE"),
    "external entity behind a comment": (b"<!-- -->\n<!-- <!DOCTYPE -->\n" + XXE + MINIMAL, 3, "DOCTYPE"),
    "external DTD": (b"\n" + EXTERNAL_DTD + MINIMAL, 2, "DOCTYPE"),
    "parameter entity": (PARAMETER_ENTITY + MINIMAL, 1, "DOCTYPE"),
    "DOCTYPE behind a byte order mark": (b"\xef\xbb\xbf" + XXE + MINIMAL, 1, "DOCTYPE"),
    "DOCTYPE behind a broken comment": (b"<!-- a -- b -->\n" + XXE + MINIMAL, 2, "DOCTYPE"),
    "DOCTYPE inside": (b"<robot name='r'>\n" + XXE + b"</robot>", 2, "well-formed"),
    "undeclared entity": (b'<robot name="r">\n&x;</robot>', 2, "well-formed"),
    "100 000 levels": (b'<robot name="r">' + b"<a>" * 60_000 + b"</a>" * 60_000 + b"</robot>", 1, "deeper than 64"),
    "65 levels": (b"<robot name='r'>" + b"\n<a>" * 64 + b"</a>" * 64 + b"</robot>", 65, "deeper than 64"),
    "100 000 links": (b'<robot name="r">\n' + b'<link name="a"/>' * 100_000 + b"</robot>", 2, "100000 links"),
    "tags without end": (b'<robot name="r">' + b"<a/>" * 7_000_000 + b"</robot>", None, "more than 200000 tags"),
    "attributes without end": (b"<robot " + b"a='' " * 500_000 + b"/>", None, "more than 400000 attributes"),
    "257 attributes": (b"<robot\n" + b" ".join(b"a%d=''" % i for i in range(257)) + b"/>", 2, "256 attributes"),
    "lines without end": (MINIMAL + b"\n" * 70_000, None, "more than 65534 lines"),
    "a value of 10 MB": (b'<robot\nname="' + b"x" * 10_100_000 + b'"/>', 2, "longer than"),
    "a value of 9 MB": (b'<robot\nname="' + b"x" * 9_000_000 + b'"/>', 2, "more than 4096 characters"),
    "a tag of 10 MB": (b"\n<" + b"x" * 10_100_000 + b"/>", 2, "longer than"),
    "text of 12 MB": (b"<robot>\n" + b"x" * 12_000_000 + b"</robot>", 2, "longer than"),
    "33 MB": (MINIMAL + b" " * (33 * 1024 * 1024), None, "at most 33554432"),
    "UTF-16": ('<?xml version="1.0"?>\n<robot name="r"/>'.encode("utf-16"), 1, "UTF-16"),
    "UTF-16 without mark": ('<robot name="r"/>'.encode("utf-16-le"), 1, "NUL"),
    "UTF-32": ('<robot name="r"/>'.encode("utf-32"), 1, "UTF-32"),
    "UTF-7 by declaration": (b'<?xml version="1.0" encoding="UTF-7"?>' + MINIMAL, 1, "encoding 'UTF-7'"),
    "Latin-1 by declaration": (b'<?xml version="1.0" encoding="latin-1"?>' + MINIMAL, 1, "encoding 'latin-1'"),
    "Latin-1 in disguise": (b'<robot name="r">\n<link name="\xe9"/></robot>', 2, "not UTF-8"),
    "overlong UTF-8": (b'<robot name="r">\n\n<link name="\xc0\xaf"/></robot>', 3, "not UTF-8"),
    "surrogate in UTF-8": (b'<robot name="r">\n<link name="\xed\xa0\x80"/></robot>', 2, "UTF-8|well-formed"),
    "NUL byte": (b'<robot name="r">\n<link name="a\0"/></robot>', 2, "NUL"),
    "NUL by reference": (b'<robot name="r">\n<link name="a&#0;"/></robot>', 2, "well-formed"),
    "truncated": (b'<robot name="r">\n<link name="a"/>\n<joint name=', 3, "well-formed"),
    "truncated between tags": (b'<robot name="r">\n<link name="a">\n', 3, "well-formed"),
    "two roots": (MINIMAL + b"\n<robot/>", 4, "well-formed"),
    "repeated attribute": (b'<robot name="r"\n name="s"/>', 2, "well-formed"),
    "not XML": (b"solid mesh\nfacet", 1, "well-formed"),
    "binary": (bytes(range(1, 256)) * 10, 1, "well-formed|UTF-8"),
}


@pytest.mark.parametrize(("data", "line", "reason"), REFUSED.values(), ids=REFUSED)
def test_attack_is_refused_with_its_line(data: bytes, line: int | None, reason: str) -> None:
    with pytest.raises(UrdfError, match=reason) as caught:
        parse_urdf(data, "robot.urdf")
    assert caught.value.line == line
    assert caught.value.path == "robot.urdf"
    assert len(str(caught.value)) < 500
    assert str(caught.value).isprintable()


ACCEPTED = {
    "byte order mark": b"\xef\xbb\xbf" + MINIMAL,
    "declared UTF-8": b'<?xml version="1.0" encoding="UTF-8" standalone="no"?>\n' + MINIMAL,
    "declared ASCII": b"<?xml version='1.0' encoding='us-ascii'?>\n" + MINIMAL,
    "64 levels": b'<robot name="r"><link name="a"/>' + b"<x>" * 63 + b"</x>" * 63 + b"</robot>",
    "DOCTYPE in a comment": b"<!-- <!DOCTYPE robot> -->" + MINIMAL,
    "DOCTYPE in character data": b'<robot name="r"><link name="a"/><x><![CDATA[<!DOCTYPE x>]]></x></robot>',
    "processing instructions": b"<?style x?>" + MINIMAL,
    "predefined entities": b'<robot name="r&amp;d"><link name="a"/></robot>',
    "a value at the limit": b'<robot name="r"><link name="a"/><x y="' + b"z" * LIMITS.value_characters + b'"/></robot>',
    "256 attributes": b'<robot name="r"><link name="a"/><x '
    + b" ".join(b"a%d=''" % i for i in range(256))
    + b"/></robot>",
    "default namespace": b'<robot name="r" xmlns="urn:x"><link name="a"/></robot>',
}


@pytest.mark.parametrize("data", ACCEPTED.values(), ids=ACCEPTED)
def test_near_miss_passes(data: bytes) -> None:
    assert parse_urdf(data).root == "a"


@pytest.mark.parametrize(
    "tail", [b'<link name="a"/>', b'<link name="a"/>\n'], ids=["no text after it", "text after it"]
)
def test_last_line_that_fits_is_right(tail: bytes) -> None:
    blank = b"\n" * (LIMITS.lines - 1 - tail.count(b"\n"))
    data = b'<robot name="r"><link name="a"/>' + blank + b"\n" + tail + b"</robot>"
    with pytest.raises(UrdfError, match="exists already on line 1") as caught:
        parse_urdf(data)
    assert caught.value.line == data.count(b"\n", 0, data.rindex(b"<link")) + 1 >= LIMITS.lines
    with pytest.raises(UrdfError, match="more than 65534 lines"):
        parse_urdf(data + b"\n" * 2)


def test_processing_instructions_and_inclusions_are_not_followed() -> None:
    inclusion = b'<xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="/etc/passwd" parse="text"/>'
    data = b'<robot name="r"><link name="a"/>' + inclusion + b"</robot>"
    assert "root:" not in parse_urdf(data).to_xml()
