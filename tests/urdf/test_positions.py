"""Where in the text elements and attributes stand."""

from __future__ import annotations

import pytest
from lxml import etree

from nao_kin.errors import UrdfError
from nao_kin.urdf import parse_urdf
from nao_kin.urdf.outline import Defect
from nao_kin.urdf.positions import Place, Positions
from nao_kin.urdf.safe_xml import read_tree

TEXT = """<?xml version="1.0"?>
<!-- <link name="no"/> -->
<robot name="ä>b"><link name='a'
   extra = "<>"/><![CDATA[<link name="neither"/>]]>
  <link
    name="b"><visual/></link>
</robot>
""".replace('"<>"', '"&lt;>"')


def positions(text: str) -> tuple[Positions, list[etree._Element]]:
    root = read_tree(text.encode(), "x")
    return Positions.of(text.encode(), root), list(root.iter(etree.Element))


@pytest.mark.parametrize(
    ("number", "attribute", "place"),
    [
        (0, "", Place(3, 2, 5)),
        (0, "name", Place(3, 14, 3)),
        (1, "", Place(3, 20, 4)),
        (1, "name", Place(3, 31, 1)),
        (1, "extra", Place(4, 13, 5)),
        (2, "", Place(5, 4, 4)),
        (2, "name", Place(6, 11, 1)),
        (3, "", Place(6, 15, 6)),
        (3, "no such", Place(6, 15, 6)),
    ],
)
def test_places_are_counted_in_characters(number: int, attribute: str, place: Place) -> None:
    where, elements = positions(TEXT)
    assert where.place(Defect("zero-axis", elements[number], "", "", attribute)) == place


def test_lines_are_quoted_without_their_ends() -> None:
    where, _ = positions('<robot name="r">\r\n<link name="a"/>\r\n</robot>')
    assert [where.line_text(line) for line in range(5)] == ["", '<robot name="r">', '<link name="a"/>', "</robot>", ""]


def test_a_byte_order_mark_shifts_nothing() -> None:
    where, elements = positions('\ufeff<robot name="r"/>')
    assert where.place(Defect("no-links", elements[0], "")) == Place(1, 2, 5)


def test_values_are_given_as_they_stand_in_the_text() -> None:
    where, elements = positions('<robot name="a\n&amp; b"/>')
    assert where.raw_value(elements[0], "name") == "a\n&amp; b"
    assert where.raw_value(elements[0], "version") is None


def test_processing_instructions_are_found_but_for_those_at_the_top() -> None:
    text = '<?xml version="1.0"?><?a?><robot name="r"><!-- <?b?> --><?c?></robot><?d?>'
    where, _ = positions(text)
    assert where.instructions() == [text.index("<?c"), text.index("<?d")]


def test_a_refusal_names_the_line_of_the_attribute() -> None:
    text = '<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="fixed"><parent link="a"/>\n'
    text += '<child\n link="c"\n/></joint></robot>'
    with pytest.raises(UrdfError) as caught:
        parse_urdf(text.encode())
    assert caught.value.line == 3
    assert caught.value.code == "unknown-child"
