"""Writes the attacks: small programs as different posts write them, and attacks.tsv beside this folder.

Each case says what happens to the part and what must come of it, thought out from geometry:
`pass` (exit code 0, PASS), `no pass` (a fail, not judged, or refused), `refused` (before motion).
The last column has words that must be said, or, behind `!`, must not be said.

    python3 generate.py        # in this folder
"""
import re
from pathlib import Path
from posts import Post

HERE = Path(__file__).parent
CASES = []
SHOP = "../../../../programs/tools.toml"


def case(name, machine, options, story, expected, text, words=""):
    assert expected in ("pass", "no pass", "refused"), name
    assert all(name != other[0] for other in CASES), name
    CASES.append((name, machine, options, story, expected, words, text))


def holes(name, post, story, expected, ops, words="", machine=None, options="", head=None, change=None, inside_frame=False):
    """A case of drilling, tapping and milling, written by a post."""
    writer = Post(post)
    text = writer.program(ops, name.replace("-", " "), head)
    if inside_frame:
        text = text.replace("G90 G54 G00", "G90 G00")
    for old, new in change or []:
        assert old in text, (name, old)
        text = text.replace(old, new, 1)
    if machine is None:
        machine = "tapping-center" if writer.family == "linuxcnc" else "machining-center"
    dialect = {"haas": "--dialect haas", "mitsubishi": "--dialect mitsubishi"}.get(writer.family, "")
    if writer.family == "fanuc" and machine != "machining-center":
        dialect = "--dialect fanuc"
    case(name, machine, f"{dialect} {options}".strip(), story, expected, text, words)


def drill(tool, points, z, **o):
    return ("drill", tool, points, z, o)


def tap(tool, points, z, **o):
    return ("tap", tool, points, z, o)


def mill(tool, s, f, moves, **o):
    return ("mill", tool, s, f, moves) if not o else ("mill", tool, s, f, moves, o["sense"])


def raw(text):
    return ("raw", text)


def slot(tool, a, b, z, s=4000, f=600):
    """A straight slot at one depth, entered by feed."""
    (ax, ay), (bx, by) = a, b
    return mill(tool, s, f, [("G0", dict(X=ax, Y=ay)), ("G0", dict(Z=2)), ("G1", dict(Z=z)), ("G1", dict(X=bx, Y=by))])


def ring(tool, x, y, r, z, s=6000, f=500):
    """A circle of the mill's centre at one depth, entered in its middle."""
    return mill(tool, s, f, [
        ("G0", dict(X=x, Y=y)), ("G0", dict(Z=2)), ("G1", dict(Z=z)), ("G1", dict(X=x + r)),
        ("G3", dict(X=x + r, Y=y, I=-r, J=0)), ("G1", dict(X=x, Y=y))])


def pocket(tool, x, y, half, z, step, s=4000, f=900):
    """A square pocket, from the middle outwards; half is the path's half side."""
    moves = [("G0", dict(X=x, Y=y)), ("G0", dict(Z=2)), ("G1", dict(Z=z))]
    side = step
    while True:
        side = min(side, half)
        moves += [("G1", dict(X=x + side, Y=y - side)), ("G1", dict(X=x + side, Y=y + side)),
                  ("G1", dict(X=x - side, Y=y + side)), ("G1", dict(X=x - side, Y=y - side)),
                  ("G1", dict(X=x + side, Y=y - side))]
        if side == half:
            return mill(tool, s, f, moves)
        side += step


def face(z, x=60):
    """The face mill once over the middle."""
    return mill(1, 1500, 900, [("G0", dict(X=-x, Y=0)), ("G0", dict(Z=z + 4)), ("G1", dict(Z=z)), ("G1", dict(X=x))])


ONE = [(0, 0)]
PAIR = [(-12, 5), (12, 5)]
SQUARE = [(15, 15), (-15, 15), (-15, -15), (15, -15)]
M6 = [drill(10, ONE, -20), tap(19, ONE, -15)]
M8 = [drill(11, ONE, -24), tap(20, ONE, -18)]


def part_good_posts():
    holes("good-lcnc-m6", "linuxcnc", "four M6 in a square", "pass", [drill(10, SQUARE, -18, cycle="G83", q=6), tap(19, SQUARE, -14, s=3000)])
    holes("good-fanuc-m8", "fanuc", "two M8, rigid by M29", "pass", [drill(11, PAIR, -24, cycle="G73", q=5), tap(20, PAIR, -18)])
    holes("good-haas-m5", "haas", "two M5 in a synchro holder", "pass", [drill(9, PAIR, -15), tap(18, PAIR, -11)])
    holes("good-mitsubishi-m12", "mitsubishi", "one M12 by ,R1", "pass", [drill(12, ONE, -28, s=1200, f=240, cycle="G83", q=8), tap(21, ONE, -22, s=400)])
    holes("good-lcnc-inch-m6", "linuxcnc-inch", "M6 by a post that writes inches, feed rounded to four places", "pass", [drill(10, PAIR, -20), tap(19, PAIR, -15, s=1777)])
    holes("good-fanuc-inch-quarter", "fanuc-inch", "1/4-20 at S1234", "pass", [drill(15, PAIR, -22), tap(22, PAIR, -15, s=1234)])
    holes("good-haas-inch-3-8", "haas-inch", "3/8-16 in inches", "pass", [drill(16, ONE, -25), tap(23, ONE, -18, s=640)])
    holes("good-fanuc-m4-pecks", "fanuc", "M4 in pecks", "pass", [drill(8, ONE, -14, s=4000, f=300), tap(17, ONE, -10, q=4, s=1000)])
    holes("good-lcnc-m8x1", "linuxcnc", "M8x1 in its own core hole", "pass", [drill(28, ONE, -22), tap(24, ONE, -16)])
    holes("good-lcnc-m6-left", "linuxcnc", "left-hand M6 by G74", "pass", [drill(10, ONE, -20), tap(25, ONE, -15)])
    holes("good-lcnc-g95", "linuxcnc", "M10 fed by the turn", "pass", [drill(27, ONE, -26, s=1800, f=300), tap(26, ONE, -20, s=600, g95=True)])
    holes("good-haas-inch-g98", "haas-inch", "M8 drilled by a post that goes back to the initial level", "pass", [drill(11, PAIR, -24, g98=True), tap(20, PAIR, -18, g98=True)])
    holes("good-deep-g81", "linuxcnc", "6.8 drilled 34 deep at once: a remark, no fail", "pass", [drill(11, ONE, -34), tap(20, ONE, -20)])
    holes("good-deep-pecks", "haas", "6.8 drilled 36 deep in pecks", "pass", [drill(11, ONE, -36, cycle="G83", q=7), tap(20, ONE, -24)])
    holes("good-pilot", "fanuc", "a pilot of 3.3, then 6.8, then M8", "pass", [drill(8, ONE, -20, s=4000), drill(11, ONE, -24), tap(20, ONE, -18)])
    holes("good-reamed", "haas", "5.8 drilled, 6.0 reamed by G85", "pass", [drill(29, ONE, -18), drill(30, ONE, -14, cycle="G85", s=800, f=150)])
    holes("good-spot-drill-tap", "mitsubishi", "spotted, drilled, tapped", "pass", [drill(7, ONE, -3.5, s=3000), drill(10, ONE, -20), tap(19, ONE, -15)])
    holes("good-drilled-twice", "linuxcnc", "the core hole drilled again after chips were blown out", "pass", [drill(11, ONE, -24), drill(11, ONE, -24), tap(20, ONE, -18)])
    holes("good-seed", "fanuc", "M8 on another machine of the series", "pass", M8, options="--seed 9")
    holes("good-shop-machine", "linuxcnc", "M6 with the scatter of a shop", "pass", M6, machine="tapping-center-shop", options="--seed 3")
    holes("good-vfd", "linuxcnc", "M8 at S1000 on a frequency converter", "pass", [drill(11, ONE, -26, s=1800, f=300), tap(20, ONE, -18, s=1000)], machine="vfd-mill")
    holes("good-tension-compression", "haas", "M6 in a tension/compression holder", "pass", [drill(10, ONE, -20), tap(33, ONE, -14, s=800)])
    case("good-brother", "tapping-center", "--dialect brother", "M6 by G100 and G77", "pass", """G90 G54
G100 T10 X8 Y-6 G43 Z10 H10 S3000 M3
G98 G81 X8 Y-6 Z-20 R2 F600
X-8
G80
G100 T19 X8 Y-6 G43 Z10 H19
G77 X8 Y-6 Z-14 R5 I1 S2500 L4000
X-8
G80
M30
""")
    case("good-brother-tpi", "tapping-center", "--dialect brother", "3/8-16 by threads per inch", "pass", """G90 G54
G100 T16 X0 Y0 G43 Z10 H16 S2000 M3
G98 G81 X0 Y0 Z-26 R2 F400
G80
G100 T23 X0 Y0 G43 Z10 H23
G77 X0 Y0 Z-18 R5 J16 S600
G80
M30
""")
    case("good-g33-1", "tapping-center", "", "M8 by G33.1", "pass", """G21 G17 G40 G49 G80 G90 G94 G54 G64 P0.01
T11 M6 G43 H11
S2400 M3
G0 X10 Y-10 Z5
G1 Z-24 F400
G0 Z20
T20 M6 G43 H20
S900 M3
G0 X10 Y-10 Z2.5
G33.1 Z-18 K1.25
G0 Z60 M5
M2
""")
    case("good-g33-1-inch", "tapping-center", "", "1/4-20 by G33.1 in inches", "pass", """G20 G17 G40 G49 G80 G90 G94 G54
T15 M6
G43 H15
S3000 M3
G0 X-0.5 Y0.25 Z0.5
G81 Z-0.9 R0.1 F12
G80
T22 M6
G43 H22
S1200 M3
G0 X-0.5 Y0.25 Z0.2
G33.1 Z-0.6 K0.05
G0 Z2 M5
M2
""")
    case("good-clutch", "tapping-center", "", "M6 in a clutch holder, without a dwell", "pass", """G21 G17 G40 G49 G80 G90 G94 G54
T10 M6
G43 H10
S3000 M3
G0 X0 Y0 Z10
G99 G81 X0 Y0 Z-22 R2 F500
G80
T32 M6
G43 H32
S800 M3
G0 X0 Y0 Z10
G98 G84 X0 Y0 Z-14 R5 F800
G80
M2
""")


def part_feeds():
    holes("feed-m8-1130", "linuxcnc", "M8 at S900: F1125 rounded up to three digits", "pass", [drill(11, ONE, -24), tap(20, ONE, -18, s=900, f=1130)])
    holes("feed-m8-1120", "haas", "M8 at S900: F1125 rounded to three digits, half to even", "pass", [drill(11, ONE, -24), tap(20, ONE, -18, s=900, f=1120)])
    holes("feed-m8-1122", "linuxcnc", "M8 at S900 with F1122: the lead comes out as 1.25 in three digits", "pass", [drill(11, ONE, -24), tap(20, ONE, -18, s=900, f=1122)])
    holes("feed-m12-753", "fanuc", "M12 at S430: F752.5 rounded", "pass", [drill(12, ONE, -26, s=1200, f=240), tap(21, ONE, -20, s=430, f=753)])
    holes("feed-m12-750", "fanuc", "M12 at S430 with two digits: 0.33 % off", "refused", [drill(12, ONE, -26, s=1200, f=240), tap(21, ONE, -20, s=430, f=750)])
    holes("feed-m5-889", "mitsubishi", "M5 at S1111: F888.8 rounded", "pass", [drill(9, ONE, -15), tap(18, ONE, -11, s=1111, f=889)])
    holes("feed-3-8-31-2", "linuxcnc-inch", "3/8-16 at S500 with F31.2 instead of 31.25", "pass", [drill(16, ONE, -25), tap(23, ONE, -18, s=500, f=31.2 * 25.4)])
    holes("feed-3-8-31", "linuxcnc-inch", "3/8-16 at S500 with F31: 0.8 % off", "refused", [drill(16, ONE, -25), tap(23, ONE, -18, s=500, f=31.0 * 25.4)])
    holes("feed-m6-of-m8", "fanuc", "M6 with the feed of M8", "refused", [drill(10, ONE, -20), tap(19, ONE, -15, s=1000, f=1250)])
    holes("feed-m8x1-as-coarse", "haas", "M8x1 with the feed of the coarse thread", "refused", [drill(28, ONE, -22), tap(24, ONE, -16, s=800, f=1000)])
    holes("feed-g95-wrong", "linuxcnc", "M10 by the turn with the lead of M8", "refused", [drill(27, ONE, -26, s=1800, f=300), tap(26, ONE, -20, s=600, g95=True)], change=[("F1.5", "F1.25")])
    holes("feed-shallow-coarse", "haas-inch", "3/8-16, 7 mm deep, F rounded to three digits", "pass", [drill(16, ONE, -16), tap(23, ONE, -7.5, s=530, f=33.1 * 25.4)])


def part_frames():
    frame = lambda text: raw(text)
    holes("frame-rotated-both", "linuxcnc", "G54 turned by 30 degrees for drill and tap alike", "pass", [frame("G10 L2 P1 R30"), drill(10, PAIR, -20), tap(19, PAIR, -15)])
    holes("frame-rotated-tap", "linuxcnc", "G54 turned by 30 degrees between drill and tap", "no pass", [drill(10, PAIR, -20), frame("G10 L2 P1 R30"), tap(19, PAIR, -15)])
    holes("frame-g68-quarter", "fanuc", "a square of holes, tapped with G68 R90 about its middle: the same places", "pass", [drill(10, SQUARE, -18), frame("G68 X0. Y0. R90."), tap(19, SQUARE, -14, s=3000), frame("G69")], inside_frame=True)
    holes("frame-g68-eighth", "fanuc", "a square of holes, tapped with G68 R45", "no pass", [drill(10, SQUARE, -18), frame("G68 X0. Y0. R45."), tap(19, SQUARE, -14, s=3000), frame("G69")], inside_frame=True)
    holes("frame-g68-both", "fanuc", "drilled and tapped in one turned frame", "pass", [frame("G68 X10. Y0. R-25."), drill(10, PAIR, -20), tap(19, PAIR, -15), frame("G69")], inside_frame=True)
    holes("frame-mirror-symmetric", "fanuc", "two holes beside X0, tapped mirrored about X0", "pass", [drill(10, PAIR, -20), frame("G51.1 X0."), tap(19, PAIR, -15), frame("G50.1 X0.")], inside_frame=True)
    holes("frame-mirror-lopsided", "fanuc", "two holes not even about X0, tapped mirrored", "no pass", [drill(10, [(-10, 5), (14, 5)], -20), frame("G51.1 X0."), tap(19, [(-10, 5), (14, 5)], -15), frame("G50.1 X0.")], inside_frame=True)
    holes("frame-mirror-both", "fanuc", "drilled and tapped in one mirrored frame", "pass", [frame("G51.1 X0."), drill(11, [(9, 4)], -24), tap(20, [(9, 4)], -18), frame("G50.1 X0.")], inside_frame=True)
    holes("frame-g55-same", "linuxcnc", "tapped in G55, set to the same place", "pass", [frame("G10 L2 P2 X-250 Y-200 Z-300"), drill(10, PAIR, -20), frame("G55"), tap(19, PAIR, -15), frame("G54")])
    holes("frame-g55-shifted", "linuxcnc", "tapped in G55, 0.3 mm beside", "no pass", [frame("G10 L2 P2 X-249.7 Y-200 Z-300"), drill(10, PAIR, -20), frame("G55"), tap(19, PAIR, -15), frame("G54")])
    holes("frame-g55-close", "linuxcnc", "tapped in G55, 0.02 mm beside: a tap finds its hole", "pass", [frame("G10 L2 P2 X-249.98 Y-200 Z-300"), drill(10, PAIR, -20), frame("G55"), tap(19, PAIR, -15), frame("G54")])
    holes("frame-g55-height", "linuxcnc", "tapped in G55, whose zero lies 4 mm higher: threads 4 mm too short", "no pass", [frame("G10 L2 P2 X-250 Y-200 Z-296"), drill(10, PAIR, -20), frame("G55"), tap(19, PAIR, -15), frame("G54")])
    holes("frame-g52-twice", "fanuc", "two parts by G52, each drilled and tapped", "pass", [frame("G52 X-40."), drill(10, PAIR, -20), frame("G52 X40."), drill(10, PAIR, -20), frame("G52 X-40."), tap(19, PAIR, -15, s=3000), frame("G52 X40."), tap(19, PAIR, -15, s=3000), frame("G52 X0.")])
    holes("frame-g52-left-on", "fanuc", "G52 of the second part left in force: taps where no hole is", "no pass", [drill(10, PAIR, -20), frame("G52 X40."), tap(19, PAIR, -15), frame("G52 X0.")])
    holes("frame-g10-l2-same", "linuxcnc", "a post that writes the offset it was set up with", "pass", [frame("G10 L2 P1 X-250 Y-200 Z-300"), *M6])
    holes("frame-g10-l2-high", "linuxcnc", "G10 puts G54 a millimetre too high", "no pass", [frame("G10 L2 P1 X-250 Y-200 Z-299"), *M6])
    case("frame-g54-1", "machining-center", "", "everything in G54.1 P3, set to G54's place", "pass", """%
O2301 (G54.1)
G21 G17 G40 G49 G80 G90
G10 L20 P3 X-510. Y-260. Z-350.
T11 M6
G54.1 P3
G0 X5. Y5. S2400 M3
G43 H11 Z20.
G99 G81 X5. Y5. Z-24. R2. F450.
G80
T20 M6
G0 X5. Y5.
G43 H20 Z20.
M29 S1200
G99 G84 X5. Y5. Z-18. R5. F1500.
G80
G91 G28 Z0.
M30
%
""")
    case("frame-g154", "machining-center", "--dialect haas", "a Haas offset G154 P2, set to G54's place", "pass", """%
O02302 (G154)
G21 G17 G40 G49 G80 G90
G10 L20 P2 X-510. Y-260. Z-350.
T10 M6
G154 P2
G0 X-20. Y0. S3000 M3
G43 H10 Z20.
G83 G99 X-20. Y0. Z-20. R2. Q6. F500.
X20.
G80
T19 M6
G0 X-20. Y0. S1500 M3
G43 H19 Z20.
G84 G99 X-20. Y0. Z-15. R5. F1500.
X20.
G80
G28 G91 Z0.
M30
%
""")
    case("frame-polar", "machining-center", "", "three holes by polar coordinates, tapped by X and Y", "pass", """%
O2303 (POLAR)
G21 G17 G40 G49 G80 G90 G54
T10 M06
G00 X20. Y0. S3500 M03
G43 H10 Z20.
G16
G99 G81 X20. Y0. Z-18. R2. F700.
Y120.
Y240.
G80
G15
T19 M06
G00 X20. Y0.
G43 H19 Z20.
M29 S2500
G99 G84 X20. Y0. Z-14. R5. F2500.
X-10. Y17.3205
Y-17.3205
G80
G91 G28 Z0.
M30
%
""")
    holes("frame-scaled-tap", "fanuc", "G51 P1010 left in force for the tap: 0.5 mm beside", "no pass", [drill(10, [(50, 0)], -20), frame("G51 X0. Y0. Z0. P1010"), tap(19, [(50, 0)], -15), frame("G50")], inside_frame=True)
    case("frame-incremental", "machining-center", "", "a row of three by G91 and K, drilled and tapped", "pass", """%
O2304 (ROW)
G21 G17 G40 G49 G80 G90 G54
T10 M6
G0 X-30. Y0. S3500 M3
G43 H10 Z10.
G91 G99 G81 X15. Z-20. R-8. F700. K3
G80 G90
T19 M6
G0 X-30. Y0.
G43 H19 Z10.
M29 S2500
G91 G99 G84 X15. Z-19. R-5. F2500. K3
G80 G90
G91 G28 Z0.
M30
%
""")
    case("frame-incremental-slip", "machining-center", "", "a row by G91: the tap's step is 15.5 instead of 15", "no pass", """%
O2305 (ROW)
G21 G17 G40 G49 G80 G90 G54
T10 M6
G0 X-30. Y0. S3500 M3
G43 H10 Z10.
G91 G99 G81 X15. Z-20. R-8. F700. K3
G80 G90
T19 M6
G0 X-30. Y0.
G43 H19 Z10.
M29 S2500
G91 G99 G84 X15.5 Z-19. R-5. F2500. K3
G80 G90
G91 G28 Z0.
M30
%
""")
    case("frame-subprogram", "machining-center", "", "places in a subprogram, called for each tool", "pass", """%
O2306 (FLANGE)
G21 G17 G40 G49 G80 G90 G54
T11 M6
G0 X0. Y18. S2400 M3
G43 H11 Z20.
G99 G81 Z-24. R2. F450. K0
M98 P2307
T20 M6
G0 X0. Y18.
G43 H20 Z20.
M29 S1500
G99 G84 Z-18. R5. F1875. K0
M98 P2307
G91 G28 Z0.
M30
O2307
X0. Y18.
X15.588 Y-9.
G80
M99
%
""")
    case("frame-g59-touched", "tapping-center", "", "G59 set by G10 L20 where the tool stands, then used", "pass", """G21 G17 G40 G49 G80 G90 G94 G54
T10 M6 G43 H10
S3000 M3
G0 X0 Y0 Z20
G10 L20 P6 X0 Y0 Z20
G59
G99 G81 X7 Y7 Z-20 R2 F600
G80
T19 M6 G43 H19
S1500 M3
G0 X7 Y7 Z20
G99 G84 Z-15 R5 F1500
G80
G0 Z60
G54
M2
""")
    case("frame-g92-z", "tapping-center", "", "G92 takes the tip's 20 mm for 23: the thread becomes 3 mm too deep", "no pass", """G21 G17 G40 G49 G80 G90 G94 G54
T10 M6 G43 H10
S3000 M3
G0 X7 Y7 Z20
G99 G81 X7 Y7 Z-24 R2 F600
G80
T19 M6 G43 H19
S1500 M3
G0 X7 Y7 Z20
G92 Z23
G99 G84 Z-15 R5 F1500
G80
G92.1
G0 Z60
M2
""")
    case("frame-g92-cancelled", "tapping-center", "", "G92 set and cancelled before anything is cut", "pass", """G21 G17 G40 G49 G80 G90 G94 G54
G0 X0 Y0
G92 X5 Y5
G92.1
T10 M6 G43 H10
S3000 M3
G0 X7 Y7 Z20
G99 G81 X7 Y7 Z-22 R2 F600
G80
T19 M6 G43 H19
S1500 M3
G0 X7 Y7 Z20
G99 G84 Z-15 R5 F1500
G80
G0 Z60
M2
""")
    case("frame-units-mixed", "tapping-center", "", "drilled in millimetres, tapped at the same places in inches", "pass", """G21 G17 G40 G49 G80 G90 G94 G54
T10 M6 G43 H10
S3000 M3
G0 X25.4 Y12.7 Z20
G99 G81 X25.4 Y12.7 Z-20 R2 F600
X-25.4
G80
T19 M6 G43 H19
G20
S1500 M3
G0 X1 Y0.5 Z1
G99 G84 X1 Y0.5 Z-0.5906 R0.2 F59.0551
X-1
G80
G0 Z2
M2
""")
    case("frame-units-slip", "tapping-center", "", "the second hole tapped five thousandths of an inch beside", "no pass", """G21 G17 G40 G49 G80 G90 G94 G54
T10 M6 G43 H10
S3000 M3
G0 X25.4 Y12.7 Z20
G99 G81 X25.4 Y12.7 Z-20 R2 F600
X-25.4
G80
T19 M6 G43 H19
G20
S1500 M3
G0 X1 Y0.5 Z1
G99 G84 X1 Y0.5 Z-0.5906 R0.2 F59.0551
X-1.005
G80
G0 Z2
M2
""")
    case("frame-increments", "tapping-center", "--dialect fanuc", "a tape without points, in thousandths", "pass", """%
O2308 (NO POINTS)
G21 G17 G40 G49 G80 G90 G54
T10 M6
S3000 M3
G0 X12000 Y-8000
G43 H10 Z20000
G99 G81 X12000 Y-8000 Z-20000 R2000 F600
G80
T19 M6
G0 X12000 Y-8000
G43 H19 Z20000
M29 S1500
G99 G84 X12000 Y-8000 Z-15000 R5000 F1500
G80
G91 G28 Z0
M30
%
""")
    case("frame-calculator", "tapping-center", "--dialect fanuc --decimal-point calculator", "a tape whose numbers without points are millimetres", "pass", """%
O2309 (CALCULATOR)
G21 G17 G40 G49 G80 G90 G54
T10 M6
S3000 M3
G0 X12 Y-8
G43 H10 Z20
G99 G81 X12 Y-8 Z-20 R2 F600
G80
T19 M6
G0 X12 Y-8
G43 H19 Z20
M29 S1500
G99 G84 X12 Y-8 Z-15 R5 F1500
G80
G91 G28 Z0
M30
%
""")
    case("frame-two-parts", "tapping-center", "", "a part in G54 and one in G55, 100 mm to the right; both drilled and tapped", "pass", """G21 G17 G40 G49 G80 G90 G94
G10 L2 P2 X-150 Y-200 Z-300
T10 M6 G43 H10
S3000 M3
G54
G0 X5 Y0 Z20
G99 G81 X5 Y0 Z-20 R2 F600
G80
G55
G0 X5 Y0
G99 G81 X5 Y0 Z-20 R2 F600
G80
T19 M6 G43 H19
S1500 M3
G0 X5 Y0 Z20
G99 G84 Z-15 R5 F1500
G80
G54
G0 X5 Y0
G99 G84 Z-15 R5 F1500
G80
G0 Z60
M2
""")
    case("frame-two-parts-one-drilled", "tapping-center", "", "two parts in G54 and G55, the second never drilled", "no pass", """G21 G17 G40 G49 G80 G90 G94
G10 L2 P2 X-150 Y-200 Z-300
T10 M6 G43 H10
S3000 M3
G54
G0 X5 Y0 Z20
G99 G81 X5 Y0 Z-20 R2 F600
G80
T19 M6 G43 H19
S1500 M3
G0 X5 Y0 Z20
G99 G84 Z-15 R5 F1500
G80
G55
G0 X5 Y0
G99 G84 Z-15 R5 F1500
G80
G54
G0 Z60
M2
""")


def part_holes():
    gone = "destroyed in line"
    holes("over-8.5-through-m8", "haas", "8.5 drilled through a finished M8", "no pass", [*M8, drill(27, ONE, -24, s=1800, f=300)], words=gone)
    holes("over-8.5-through-m8-inch", "fanuc-inch", "8.5 drilled through one of two M8, places in inches", "no pass", [drill(11, PAIR, -24), tap(20, PAIR, -18), drill(27, PAIR[:1], -24, s=1800, f=300)], words=gone)
    holes("over-8.5-countersunk", "haas", "8.5 drilled 1.5 mm into the mouth of M8: a chamfer", "pass", [*M8, drill(27, ONE, -1.5, s=1800, f=300)])
    holes("over-14-mouth", "fanuc", "14 drilled 7 mm into the mouth of M8", "no pass", [*M8, drill(14, ONE, -7, s=900, f=150)], words=gone)
    holes("over-clearance", "mitsubishi", "a finished M6 drilled to its clearance hole", "no pass", [*M6, drill(13, ONE, -22)], words=gone)
    holes("over-core-deeper", "linuxcnc", "the core drill once more through M6, deeper: takes no thread", "pass", [*M6, drill(10, ONE, -30, cycle="G83", q=6)])
    holes("retap-same", "linuxcnc", "tapped twice alike", "pass", [drill(10, ONE, -20), tap(19, ONE, -15), tap(19, ONE, -15)])
    holes("retap-crossed", "linuxcnc", "tapped again from an R 0.4 of a pitch higher: crossed", "no pass", [drill(10, ONE, -20), tap(19, ONE, -15), tap(19, ONE, -15, r=5.4)])
    holes("retap-whole-pitches", "haas", "tapped again from an R two pitches higher: the same groove", "pass", [drill(10, ONE, -20), tap(19, ONE, -15), tap(19, ONE, -15, r=7)])
    holes("retap-fine-over-coarse", "fanuc", "M8x1 tapped over M8", "no pass", [*M8, tap(24, ONE, -16)])
    holes("retap-left-over-right", "linuxcnc", "left-hand M6 over M6", "no pass", [*M6, tap(25, ONE, -15)])
    holes("retap-m10-over-m8", "haas", "M10 over M8, without its own core hole", "no pass", [*M8, tap(26, ONE, -16, s=500)])
    case("retap-second-start", "tapping-center", "", "a second start at 180 degrees in the same hole", "no pass", """G21 G17 G40 G49 G80 G90 G94 G54
T11 M6 G43 H11
S2400 M3
G0 X0 Y0 Z10
G99 G81 X0 Y0 Z-24 R2 F400
G80
T20 M6 G43 H20
G0 X0 Y0 Z10
M5
S1000
G95 F1.25
G84.2 X0 Y0 Z-16 R5
G80
G84.2 X0 Y0 Z-16 R5 A180
G80
G94
G0 Z50
M2
""")
    holes("near-hole-into-thread", "linuxcnc", "6.8 drilled 7.3 beside a finished M8: into its flank", "no pass", [*M8, drill(11, [(7.3, 0)], -20)])
    holes("near-hole-before-thread", "haas", "6.8 drilled 7.3 beside where M8 is tapped later", "no pass", [drill(11, [(0, 0), (7.3, 0)], -24), tap(20, ONE, -18)])
    holes("near-hole-with-wall", "linuxcnc", "6.8 drilled 9.5 beside M8: 2.1 mm of wall", "pass", [*M8, drill(11, [(9.5, 0)], -20)])
    holes("near-two-threads", "fanuc", "two M8 at 7.9: their bores have a wall, their threads none", "no pass", [drill(11, [(0, 0), (7.9, 0)], -24), tap(20, [(0, 0), (7.9, 0)], -18)])
    holes("near-two-threads-apart", "fanuc", "two M8 at 12", "pass", [drill(11, [(0, 0), (0, 12)], -24), tap(20, [(0, 0), (0, 12)], -18)])
    holes("near-plain-holes", "mitsubishi", "holes of 14 and 6.8 at 10.3: they break into one another", "no pass", [drill(14, ONE, -20, s=900, f=200), drill(11, [(0, 10.3)], -20)])
    holes("near-plain-holes-apart", "mitsubishi", "holes of 14 and 6.8 at 13", "pass", [drill(14, ONE, -20, s=900, f=200), drill(11, [(0, 13)], -20)])
    holes("near-diagonal", "haas-inch", "two 5.0 holes 3 and 3 mm apart: 4.24 between centres", "no pass", [drill(10, [(0, 0), (3, 3)], -15)])
    holes("near-other-depth", "linuxcnc", "a shallow 14 beside M8 reaches its mouth alone: still into the thread", "no pass", [*M8, drill(14, [(10.2, 0)], -12, s=900, f=200)])
    holes("missing-spot-only", "fanuc", "spotted, never drilled, tapped", "no pass", [drill(7, ONE, -3), tap(20, ONE, -15)])
    holes("missing-core-too-small", "linuxcnc", "M6 in a hole of 3.3", "no pass", [drill(8, ONE, -20, s=4000), tap(19, ONE, -15)])
    holes("missing-core-too-large", "linuxcnc", "M6 in a hole of 6.6: no thread", "no pass", [drill(13, ONE, -22), tap(19, ONE, -15)])
    holes("missing-core-slightly-large", "haas", "M6 in a hole of 5.8: above D1's limit of 5.153", "no pass", [drill(29, ONE, -22), tap(19, ONE, -15)])
    holes("missing-core-of-coarse", "haas", "M8 in the core hole of M8x1: 7.0, limit 6.912", "no pass", [drill(28, ONE, -24), tap(20, ONE, -18)])
    holes("missing-one-of-four", "fanuc", "the drill has three places, the tap four", "no pass", [drill(10, SQUARE[:3], -18), tap(19, SQUARE, -14, s=3000)])
    holes("missing-beside", "haas", "the hole was drilled two millimetres beside", "no pass", [drill(10, [(2, 0)], -20), tap(19, ONE, -15)])
    holes("missing-other-sign", "linuxcnc-inch", "the tap's Y has the other sign", "no pass", [drill(10, [(10, 8)], -20), tap(19, [(10, -8)], -15)])
    holes("missing-drilled-after", "linuxcnc", "tapped first, drilled afterwards", "no pass", [tap(19, ONE, -15), drill(10, ONE, -20)])
    holes("missing-neighbour-drilled", "mitsubishi", "a neighbour drilled for M8 and tapped; M6 beside it in no hole", "no pass", [*M8, tap(19, [(25, 0)], -12)])
    holes("stated-pre-drilled", "linuxcnc", "a comment states that the holes are there", "pass", [tap(19, PAIR, -15)], head=["(PRE-DRILLED)"], words="!IF THE HOLES")
    holes("stated-option", "fanuc", "--pre-drilled states it", "pass", [tap(20, PAIR, -15)], options="--pre-drilled", words="!IF THE HOLES")
    holes("unstated-holes", "haas", "taps alone: the verdict's first line names the condition", "pass", [tap(20, PAIR, -15)], words="IF THE HOLES ARE THERE")
    holes("offset-drill-too-deep", "linuxcnc", "the drill goes by the length of a shorter tool: 9 mm too deep", "no pass", M6, change=[("G43 H10", "G43 H9")])
    holes("offset-tap-too-shallow", "linuxcnc", "the tap goes by the length of a longer one: 7 mm too high", "no pass", M6, change=[("G43 H19", "G43 H20")])
    holes("offset-forgotten", "haas", "no G43 for the drill: the gauge line goes where the tip should", "no pass", M6, change=[("G43 Z20. H10", "Z20.")])
    holes("offset-drill-in-air", "fanuc", "the drill goes by the length of the longest tool: it stays above the work", "no pass", [drill(10, ONE, -20), tap(19, ONE, -15)], change=[("G43 H10", "G43 H14")])
    holes("refused-deeper-than-hole", "linuxcnc", "tapped deeper than drilled", "refused", [drill(10, ONE, -14), tap(19, ONE, -15)])
    holes("refused-point-of-drill", "fanuc", "tapped into the drill's point", "refused", [drill(10, ONE, -15.5), tap(19, ONE, -15)])
    holes("refused-hand", "linuxcnc", "a right-hand tap by G74", "refused", [drill(10, ONE, -20), tap(19, ONE, -15, left=True)])
    holes("refused-left-by-g84", "linuxcnc", "a left-hand tap by G84", "refused", [drill(10, ONE, -20), tap(25, ONE, -15, left=False)])
    holes("refused-flutes", "linuxcnc", "M6 26 deep with 24 mm of flutes", "refused", [drill(10, ONE, -32, cycle="G83", q=6), tap(19, ONE, -26)])
    holes("refused-standing-spindle", "linuxcnc", "G84 with the spindle at rest", "refused", M6, change=[("S1500 M3", "M5")])
    case("refused-g33-1-lead", "tapping-center", "", "M8 by G33.1 with K1", "refused", """G21 G17 G40 G49 G80 G90 G94 G54
T11 M6 G43 H11
S2400 M3
G0 X0 Y0 Z5
G81 Z-24 R2 F400
G80
T20 M6 G43 H20
S900 M3
G0 X0 Y0 Z2
G33.1 Z-18 K1
M2
""")
    holes("plate-through", "linuxcnc", "M6 through a plate of 12 mm", "pass", [drill(10, ONE, -20), tap(19, ONE, -16)], head=["(STOCK X-50 Y-30 Z-12 X50 Y30 Z0)"])
    holes("plate-inside", "fanuc-inch", "1/4-20 within a stated block, in inches", "pass", [drill(15, [(20, 20)], -20), tap(22, [(20, 20)], -14)], head=["(STOCK X0 Y0 Z-1 X3 Y2 Z0)"])
    holes("plate-outside", "linuxcnc", "tapped 10 mm beside a stated block", "no pass", [drill(10, [(70, 20)], -20), tap(19, [(70, 20)], -15)], head=["(STOCK X0 Y0 Z-25 X60 Y40 Z0)"])
    holes("plate-over-edge", "haas", "M8 whose hole reaches over the block's side", "no pass", [drill(11, [(58, 20)], -20), tap(20, [(58, 20)], -14)], head=["(STOCK X0 Y0 Z-25 X60 Y40 Z0)"])
    holes("plate-flank-over-edge", "haas", "M8 3.8 from the side: the bore has a wall, the thread none", "no pass", [drill(11, [(56.2, 20)], -20), tap(20, [(56.2, 20)], -14)], head=["(STOCK X0 Y0 Z-25 X60 Y40 Z0)"])
    holes("plate-not-faced", "linuxcnc", "three millimetres stand over Z0 and are not faced: the drill's R lies in them", "no pass", M6, head=["(STOCK X-50 Y-30 Z-25 X50 Y30 Z3)"])
    holes("far-outside-table", "linuxcnc", "a hole beyond the machine's stock: X210 of 200", "no pass", [drill(10, [(210, 0)], -20), tap(19, [(210, 0)], -15)])


def part_mills():
    gone = "destroyed in line"
    flank = [(11.5, -20), (11.5, 20)]
    holes("mill-slot-through-flank", "linuxcnc", "a slot of 16 beside M8 takes half a millimetre of its flank, not of its bore", "no pass", [*M8, slot(2, flank[0], flank[1], -12)])
    holes("mill-slot-with-wall", "linuxcnc", "the same slot 1.7 mm farther: a wall", "pass", [*M8, slot(2, (13.2, -20), (13.2, 20), -12)])
    holes("mill-slot-before-thread", "haas", "the slot was there before: drill and tap break into it", "no pass", [slot(2, flank[0], flank[1], -12), *M8])
    holes("mill-slot-across", "fanuc", "a slot of 4 across a finished M12, 3 mm deep", "no pass", [drill(12, ONE, -28, s=1200, f=240), tap(21, ONE, -22, s=500), slot(4, (-15, 0), (15, 0), -3, s=6000)])
    holes("mill-pocket-after", "haas", "a pocket of 20 over M8, 6 mm deep", "no pass", [*M8, pocket(3, 0, 0, 6, -6, 3)])
    holes("mill-pocket-under", "linuxcnc", "M8 in the floor of a pocket, R below the top: ordered so", "pass", [pocket(3, 0, 0, 10, -8, 5), drill(11, ONE, -28, r=-6), tap(20, ONE, -22, r=-4)])
    holes("mill-pocket-too-deep", "linuxcnc", "a pocket of 18 where M8 is tapped 22 deep from the top: 1 mm of thread", "no pass", [pocket(3, 0, 0, 10, -18, 5), drill(11, ONE, -28), tap(20, ONE, -22)])
    holes("mill-pocket-deeper-than-hole", "fanuc", "a hole 8 deep drilled in a pocket of 12: in the air", "no pass", [pocket(3, 0, 0, 10, -12, 5), drill(11, ONE, -8)])
    holes("mill-pocket-entry", "haas", "a hole as the entry of a pocket", "pass", [drill(14, ONE, -8, s=900, f=200), pocket(3, 0, 0, 10, -8, 5)])
    holes("mill-hole-in-pocket", "mitsubishi", "a hole through a pocket's floor", "pass", [pocket(3, 0, 0, 10, -6, 5), drill(11, [(3, 3)], -20)])
    holes("mill-wall-of-pocket", "linuxcnc", "M8 3.7 beside a pocket's wall: the bore has a wall, the thread none", "no pass", [pocket(3, 0, 0, 8, -12, 4), drill(11, [(15.7, 0)], -24), tap(20, [(15.7, 0)], -18)])
    holes("mill-wall-of-pocket-far", "linuxcnc", "M8 6 beside a pocket's wall", "pass", [pocket(3, 0, 0, 8, -12, 4), drill(11, [(18, 0)], -24), tap(20, [(18, 0)], -18)])
    holes("mill-counterbore", "haas", "a counterbore of 16, 6 deep; M8 24 deep keeps most of its thread", "pass", [drill(2, ONE, -6, s=1500, f=200), drill(11, ONE, -30), tap(20, ONE, -24)])
    holes("mill-counterbore-deep", "haas", "a counterbore of 16, 16 deep; of M8 24 deep a quarter is left", "no pass", [drill(2, ONE, -16, s=1500, f=200), drill(11, ONE, -30), tap(20, ONE, -24)])
    holes("mill-counterbore-ordered", "fanuc", "the same counterbore, with R in it: ordered so", "pass", [drill(2, ONE, -14, s=1500, f=200), drill(11, ONE, -32, r=-12), tap(20, ONE, -26, r=-10)])
    holes("mill-counterbore-after", "fanuc", "the counterbore of 16 cut after the thread", "no pass", [drill(11, ONE, -30), tap(20, ONE, -24), drill(2, ONE, -14, s=1500, f=200)], words=gone)
    holes("mill-chamfer-spot", "linuxcnc", "chamfered by the spot drill to 8.8 after tapping", "pass", [*M8, drill(7, ONE, -4.4, s=2000, f=200)])
    holes("mill-chamfer-spot-deep", "linuxcnc", "the spot drill goes 9 deep into the finished M8", "no pass", [*M8, drill(7, ONE, -9, s=2000, f=200)])
    holes("mill-chamfer-ring", "fanuc", "chamfered to 9 by a chamfer mill in a circle", "pass", [*M8, ring(6, 0, 0, 1.0, -3.5, s=4000, f=300)])
    holes("mill-chamfer-ring-deep", "fanuc", "the chamfer mill goes 4 mm farther out than it should: the mouth is 17 wide", "no pass", [*M8, ring(6, 0, 0, 4.0, -5.5, s=4000, f=300)])
    holes("mill-ball-groove", "haas", "a ball of 6 across M8, 5 deep", "no pass", [*M8, slot(5, (-15, 0), (15, 0), -5, s=6000)])
    holes("mill-faced-0.05", "linuxcnc", "0.05 faced off after tapping: cleaned", "pass", [*M8, face(-0.05)])
    holes("mill-faced-3", "linuxcnc", "3 mm faced off after tapping", "no pass", [*M8, face(-3)])
    holes("mill-faced-first", "linuxcnc", "2 mm over Z0 are faced first", "pass", [face(0), *M6], head=["(STOCK X-50 Y-20 Z-25 X50 Y20 Z2)"])
    holes("mill-faced-last", "linuxcnc", "2 mm over Z0 are faced after drill and tap: the thread is as long as ordered from Z0", "pass", [drill(10, ONE, -20, r=4), tap(19, ONE, -15, r=7), face(0)], head=["(STOCK X-50 Y-20 Z-25 X50 Y20 Z2)"])
    holes("mill-bore-as-core", "linuxcnc", "the core of M8 milled in a circle to 6.8", "pass", [ring(4, 0, 0, 1.4, -20, s=6000, f=300), tap(20, ONE, -15)])
    holes("mill-bore-too-large", "linuxcnc", "the core of M8 milled to 7.6", "no pass", [ring(4, 0, 0, 1.8, -20, s=6000, f=300), tap(20, ONE, -15)])
    holes("mill-bore-too-small", "haas", "the core of M8 milled to 6.0", "no pass", [ring(4, 0, 0, 1.0, -20, s=6000, f=300), tap(20, ONE, -15)])
    holes("mill-drilled-by-g1", "fanuc", "the core drilled by G1", "pass", [mill(11, 2400, 400, [("G0", dict(X=0, Y=0)), ("G0", dict(Z=2)), ("G1", dict(Z=-24))]), tap(20, ONE, -18)])
    holes("mill-good-slot", "fanuc-inch", "a slot, 6 deep", "pass", [slot(3, (-20, 0), (20, 0), -6, s=5000, f=500)])
    holes("mill-good-pocket", "mitsubishi", "a square pocket", "pass", [pocket(3, 0, 0, 10, -5, 5, s=5000, f=900)])
    holes("mill-rapid-plunge", "linuxcnc", "the slot entered by a rapid", "no pass", [mill(3, 5000, 500, [("G0", dict(X=-20, Y=0)), ("G0", dict(Z=-6)), ("G1", dict(X=20))])])
    holes("mill-rapid-across", "haas", "from one slot to the next at depth, by a rapid through the wall", "no pass", [mill(3, 5000, 500, [("G0", dict(X=-20, Y=0)), ("G0", dict(Z=2)), ("G1", dict(Z=-5)), ("G1", dict(X=20)), ("G0", dict(Y=20)), ("G1", dict(X=-20))])])
    holes("mill-backwards", "linuxcnc", "a slot with M4", "no pass", [mill(3, 5000, 500, [("G0", dict(X=-20, Y=0)), ("G0", dict(Z=2)), ("G1", dict(Z=-5)), ("G1", dict(X=20))], sense="M4")])
    holes("mill-chip-too-thick", "linuxcnc", "F6000 at S1000 with four teeth: 1.5 a tooth, 0.5 allowed", "no pass", [slot(2, (-20, 0), (20, 0), -5, s=1000, f=6000)])
    holes("mill-too-deep-a-cut", "haas", "a slot 30 deep at once, 25 allowed", "no pass", [slot(2, (-20, 0), (20, 0), -30, s=3000, f=400)])
    holes("mill-stock-assumed", "linuxcnc", "a slot beyond the machine's stock: it is assumed, so not judged", "no pass", [slot(3, (215, -20), (215, 20), -6, s=5000, f=500)])
    holes("mill-stock-size-alone", "linuxcnc", "a size alone: its place is assumed, so not judged", "no pass", [slot(3, (-20, 0), (20, 0), -6, s=5000, f=500)], head=["(STOCK 100X60X20)"])
    case("mill-g41-contour", "machining-center", "", "a contour by G41 and a pocket's wall by arcs", "pass", """%
O4101 (CONTOUR)
(STOCK X-40. Y-30. Z-20. X40. Y30. Z0.)
G21 G17 G40 G49 G80 G90 G54
T2 M6
G10 L12 P2 R8.
S3500 M3
G0 X-60. Y-45.
G43 H2 Z10.
G1 Z-6. F2000.
G41 D2 X-36. Y-40. F900.
Y26.
X36.
Y-26.
X-55.
G40 X-65. Y-45.
G0 Z20.
G91 G28 Z0.
M30
%
""")
    case("mill-haas-g13", "machining-center", "--dialect haas", "a round pocket by G13, a hole through its floor", "pass", """%
O04102 (ROUND POCKET)
G21 G17 G40 G49 G80 G90 G54
T3 M06
S5000 M03
G00 X0. Y0.
G43 Z10. H3
G01 Z1. F800.
G13 Z-5. I5. K12. Q5. D0 F600.
G00 Z20.
T11 M06
S2400 M03
G00 X0. Y0.
G43 Z20. H11
G81 G99 X0. Y0. Z-20. R-3. F450.
G80
G28 G91 Z0.
M30
%
""")
    case("mill-router", "router", "", "a groove on a router, by Grbl's words, in inches", "pass", """G20 G90 G94 G17
G54
T3 M6
M3 S12000
G0 X-1 Y0
G43.1 Z3.9961
G0 Z0.2
G1 Z-0.1 F20
G1 X1 Y0.5 F40
G0 Z0.5
M5
M30
""")
    case("mill-thread-mill", "tapping-center", "", "a thread milled by a helix with a tool of which nothing is known", "no pass", """G21 G17 G40 G49 G80 G90 G94 G54
T11 M6 G43 H11
S2400 M3
G0 X0 Y0 Z10
G81 X0 Y0 Z-24 R2 F400
G80
T31 M6 G43 H31
S3000 M3
G0 X0 Y0 Z5
G1 Z-15 F500
G1 X1.0 F200
G3 X1.0 Y0 Z-13.75 I-1 J0 F200
G3 X1.0 Y0 Z-12.5 I-1 J0
G1 X0
G0 Z20
M2
""")
    case("mill-helix-bore", "tapping-center", "", "a bore of 14 by a helix with the mill of 8", "pass", """G21 G17 G40 G49 G80 G90 G94 G54
T3 M6 G43 H3
S5000 M3
G0 X3 Y0 Z2
G1 Z0.5 F800
G3 X3 Y0 Z-2 I-3 J0 F600
G3 X3 Y0 Z-4 I-3 J0
G3 X3 Y0 Z-6 I-3 J0
G3 X3 Y0 Z-6 I-3 J0
G1 X0
G0 Z30
M2
""")


def part_faults():
    one = [drill(11, ONE, -24), tap(20, ONE, -18, s=3000)]
    whole = "!the tool is broken"
    holes("fault-dropout", "linuxcnc", "the spindle's encoder silent for 5 ms in the thread; taken out", "no pass", one, options="--fault 'dropout 5ms at 6.5s' --recover", words=whole)
    holes("fault-slip", "linuxcnc", "the spindle's encoder slips by 40 degrees; taken out", "no pass", one, options="--fault 'encoder-slip 40deg at 6.5s' --recover", words=whole)
    holes("fault-feedback-lost", "fanuc", "half a millisecond without feedback in the thread: bridged", "pass", one, options="--fault 'feedback-lost 0.5ms at 11.25s' --recover", words=whole)
    holes("fault-power-cut", "haas", "a power cut in the thread, on the way out", "no pass", one, options="--fault 'power-cut at 11.6s' --recover", words=whole)
    holes("fault-fast-dropout", "linuxcnc", "M6 at S6000, encoder silent for 5 ms near the bottom", "no pass", [drill(10, ONE, -24), tap(19, ONE, -18, s=6000)], options="--fault 'dropout 5ms at 6.68s' --recover", words=whole)
    holes("fault-not-met", "linuxcnc", "a fault ordered at a depth that nothing reaches", "no pass", one, options="--fault 'power-cut at depth 60mm'")
    holes("fault-scale-small", "haas", "a scale error of 20 ppm on Z from 1 s on: a few micrometres", "pass", one, options="--fault 'scale-error Z 20ppm at 1s'")
    holes("fault-scale-large", "linuxcnc", "a scale error of 3000 ppm on X from the start: 0.75 mm beside", "no pass", one, options="--fault 'scale-error X 3000ppm at 0.1s'")
    holes("operator-hold", "linuxcnc", "a hold and a resume while drilling", "pass", one, options="--operator 'hold at 2s; resume at 3s'")
    holes("operator-override", "fanuc", "feed at 150 %, spindle at 80 %: locked in the thread", "pass", one, options="--operator 'override 150 at 1s; spindle-override 80 at 1s'")
    holes("operator-abort", "haas", "aborted while drilling", "no pass", one, options="--operator 'abort at depth 5mm'")


TURN_HEAD = "G21 G18 G90 G94 G8\n"
THREAD = """T4 M6
G43 H4
S1000 M3
G0 X11 Y0 Z6
G76 P1.5 Z-15 I-1 J0.4 K0.985 R1.5 Q29.5 H1 E1.5 L2
G0 X30 Z50
"""
LATHE = "--tools turning.toml"
FANUC_LATHE = "--tools turning.toml --dialect fanuc-lathe-a"


def turned(name, story, expected, body, words="", options=LATHE, machine="lathe"):
    case(name, machine, options, story, expected, f"({name.replace('-', ' ')})\n{TURN_HEAD}{body}M5\nM2\n", words)


def fanuc_turned(name, story, expected, body, words="", options=FANUC_LATHE, machine="lathe"):
    case(name, machine, options, story, expected, f"%\nO{sum(map(ord, name)) % 9000 + 100:04} ({name.upper()})\nG21 G18 G40 G97 G99\n{body}M5\nM30\n%\n", words)


def with_tool(tool, moves, s=1000):
    return f"T{tool} M6\nG43 H{tool}\nS{s} M3\nG0 X30 Y0 Z10\n{moves}G0 X30\nG0 Z50\n"


def part_turning():
    turned("turn-good", "M20x1.5 with a full profile", "pass", THREAD)
    turned("turn-good-radial", "the same, fed in radially, no taper at its end", "pass", THREAD.replace(" Q29.5", "").replace(" E1.5 L2", "").replace("Z-15", "Z-18"))
    fanuc_turned("turn-good-g92", "M20x1.5 by G92, a spring pass", "pass", """T0404
G97 S900 M3
G0 X24. Y0 Z6.
G92 X19.3 Z-18. F1.5
X18.8
X18.45
X18.2
X18.05
X18.03
X18.03
G0 X60. Z50.
""")
    fanuc_turned("turn-good-g76-two-lines", "M20x1.5 by G76 in two lines", "pass", """T0404
G97 S900 M3
G0 X24. Y0 Z6.
G76 P010060 Q100 R0.05
G76 X18.03 Z-18. P985 Q300 F1.5
G0 X60. Z50.
""")
    case("turn-good-system-b", "lathe", "--tools turning.toml --dialect fanuc-lathe-b", "M20x1.5 by G78 of code system B", "pass", """%
O5103 (SYSTEM B)
G21 G18 G40 G97 G95 G90
T0404
S900 M3
G0 X24. Y0 Z6.
G78 X19.2 Z-16. F1.5
X18.6
X18.25
X18.05
X18.03
G0 X60. Z50.
M5
M30
%
""")
    fanuc_turned("turn-good-g32", "M20x1.5 by G32, pass by pass", "pass", "T0404\nG97 S900 M3\nG0 X24. Y0 Z6.\n" + "".join(
        f"G0 X{x}\nG32 Z-16. F1.5\nG0 X24.\nZ6.\n" for x in ("19.3", "18.75", "18.4", "18.15", "18.03", "18.03")) + "G0 X60. Z50.\n")
    turned("turn-good-g33", "M20x2 by G33 in diameters, turned to 19.82 first, partial profile", "pass", """G7
T1 M6
G43 H1
S1500 M3
G0 X24 Y0 Z2
G0 X19.82
G1 Z-26 F350
G0 X24
T3 M6
G43 H3
S800 M3
G0 X24 Y0 Z8
""" + "".join(
        f"G0 X{x}\nG33 Z-20 K2\nG0 X24\nG0 Z8\n" for x in ("19.2", "18.6", "18.1", "17.7", "17.4", "17.251", "17.251")))
    case("turn-good-inch", "lathe", FANUC_LATHE, "3/4-16 UNF in inches, turned to 0.744 first", "pass", """%
O5101 (3/4-16 UNF)
G20 G18 G40 G97 G99
T0101
G97 S1500 M3
G0 X0.9 Y0 Z0.1
X0.744
G1 Z-1. F0.01
G0 X0.9
G0 X2. Z2.
T0303
G97 S800 M3
G0 X0.9 Y0 Z0.3
G92 X0.72 Z-0.75 F0.0625
X0.7
X0.685
X0.674
X0.667
X0.667
G0 X2. Z2.
M5
M30
%
""")
    case("turn-good-turning-center", "turning-center", "--tools turning.toml", "M16x1.5 on a bar of 20: faced, turned, threaded, parted off behind", "pass", """%
O5102 (STUD M16X1.5)
(STOCK X-10. Y-10. Z-60. X10. Y10. Z0.5)
G21 G18 G40 G97 G99
G50 S3000
T0101
G96 S150 M3
G0 X24. Y0 Z5.
Z0
G1 X-1.6 F0.15
G0 Z2.
X18.
G1 Z-30. F0.25
X21.
G0 Z2.
X15.85
G1 Z-26. F0.2
X21.
G97 S600
G0 X60. Z60.
T0303
G97 S900 M3
G0 X20. Z6.
G76 P010060 Q100 R0.03
G76 X14.025 Z-20. P912 Q250 F1.5
G0 X60. Z60.
T0505
G97 S800 M3
G0 X24. Z-36.
G1 X-0.4 F0.1
G0 X60.
Z60.
M5
M30
%
""")
    inside = """T7 M6
G43 H7
S600 M3
G0 X0 Y0 Z5
G1 Z-24 F90
G0 Z50
T6 M6
G43 H6
S900 M3
G0 X6.5 Y0 Z6
G76 P1.5 Z-14 I0.75 J0.25 K0.8595 R1.5 Q29.5 H1
G0 Z50
"""
    turned("turn-good-internal", "M16x1.5 in a bore of 14.5", "pass", inside)
    turned("turn-internal-too-deep", "M16x1.5 in a bore, 0.2 too deep on the radius", "no pass", inside.replace("K0.8595", "K1.0595"))
    turned("turn-internal-no-bore", "M16x1.5 where the bore was never drilled: the insert goes into solid", "no pass", inside[inside.index("T6"):])
    turned("turn-two-inserts", "roughed by one insert, finished by another", "pass", THREAD.replace("T4", "T10").replace("H4", "H10").replace("K0.985", "K0.75") + THREAD)
    turned("turn-rough-and-finish", "roughed and finished by two G76", "pass", THREAD.replace("K0.985", "K0.8").replace("E1.5 L2", "") + THREAD)
    turned("turn-spring-pass", "the whole cycle once more", "pass", THREAD + THREAD)
    turned("turn-finish-shorter", "finished over 8 of 15 mm", "no pass", THREAD.replace("K0.985", "K0.7") + THREAD.replace("Z-15", "Z-8"))
    turned("turn-again-shifted", "cut again half a millimetre beside", "no pass", THREAD + THREAD.replace("Z6", "Z6.5"))
    turned("turn-again-whole-pitch", "cut again from two pitches farther out", "pass", THREAD + THREAD.replace("Z6", "Z9"))
    starts = lambda shifts: "T4 M6\nG43 H4\nS500 M3\nG0 X12 Y0 Z10\n" + "".join(
        f"G0 X{x}\nG33 Z-15 K3\nG0 X12\nG0 Z{10 + s}\n".replace("G0 X" + x, f"G0 Z{10 + s}\nG0 X{x}") for s in shifts for x in ("9.7", "9.4", "9.2", "9.08", "9.013"))
    turned("turn-two-starts", "M20 of two starts, lead 3, by G33 from two places", "pass", starts((0, 1.5)))
    turned("turn-one-of-two-starts", "one of two starts: lands of three millimetres", "no pass", starts((0,)))
    turned("turn-two-starts-uneven", "two starts, the second 1.1 instead of 1.5 beside", "no pass", starts((0, 1.1)))
    fanuc_turned("turn-two-starts-q", "two starts by Q of G32", "pass", "T0404\nG97 S500 M3\nG0 X24. Y0 Z10.\n" + "".join(
        f"G0 X{x}\nG32 Z-15. F3. Q{q}\nG0 X24.\nZ10.\n" for q in (0, 180000) for x in ("19.4", "18.8", "18.4", "18.15", "18.026")) + "G0 X60. Z50.\n")
    turned("turn-wrong-lead", "lead 1.25 on a bar of 20: no thread of a standard", "no pass", THREAD.replace("P1.5", "P1.25"))
    turned("turn-too-shallow", "0.15 too shallow", "no pass", THREAD.replace("K0.985", "K0.835"))
    turned("turn-too-deep", "0.15 too deep", "no pass", THREAD.replace("K0.985", "K1.135"))
    turned("turn-offset-0.1", "the drive line a tenth too far out", "no pass", THREAD.replace("X11 ", "X11.1 "))
    turned("turn-offset-0.01", "the drive line a hundredth too far out: within 6g", "pass", THREAD.replace("X11 ", "X11.01 "))
    turned("turn-left-hand-unasked", "M4 with a right-hand insert: a left-hand thread, said before motion", "pass", THREAD.replace("M3", "M4"), words="give a left-hand thread")
    turned("turn-left-over-right", "a left-hand helix over the finished thread", "no pass", THREAD + THREAD.replace("M3", "M4"))
    turned("turn-in-air", "the insert stays 2 mm beside the bar", "no pass", THREAD.replace("X11 ", "X14 "))
    turned("turn-crest-uncut", "a partial profile on the bar of 20.0: crests above 6g", "no pass", THREAD.replace("T4", "T3").replace("H4", "H3"))
    turned("turn-other-lead-over", "a lead of 2 over the finished 1.5", "no pass", THREAD + THREAD.replace("P1.5", "P2"))
    turned("turn-chain", "two blocks of G33 in one line: one thread", "pass", "T4 M6\nG43 H4\nS900 M3\nG0 X12 Y0 Z6\n" + "".join(
        f"G0 X{x}\nG33 Z-7 K1.5\nG33 Z-16 K1.5\nG0 X12\nG0 Z6\n" for x in ("9.65", "9.38", "9.2", "9.08", "9.015")))
    turned("turn-chain-two-leads", "a chain whose second block has another lead: as ordered", "pass", "T4 M6\nG43 H4\nS900 M3\nG0 X12 Y0 Z6\n" + "".join(
        f"G0 X{x}\nG33 Z-7 K1.5\nG33 Z-16 K1.75\nG0 X12\nG0 Z6\n" for x in ("9.65", "9.38", "9.2", "9.08", "9.015")))
    groove = lambda z, x, f=60: with_tool(5, f"G0 Z{z}\nG0 X11\nG1 X{x} F{f}\nG0 X12\n", s=800)
    turned("turn-groove-in-thread", "a groove of 2 mm into the middle of the thread", "no pass", THREAD + groove(-8, 8.5), words="destroyed in line")
    turned("turn-relief-before", "a relief groove first, the thread ends in it", "pass", groove(-18, 8.6) + groove(-16.5, 8.6) + THREAD.replace(" E1.5 L2", "").replace("Z-15", "Z-17"))
    turned("turn-relief-after", "a relief groove at the thread's end afterwards", "pass", THREAD.replace(" E1.5 L2", "") + groove(-16, 8.6) + groove(-17, 8.6))
    turned("turn-parted-behind", "parted off behind the thread", "pass", THREAD + groove(-24, -0.2, f=150))
    turned("turn-parted-through", "parted off in the middle of the thread", "no pass", THREAD + groove(-8, -0.2, f=150))
    turned("turn-faced-0.5", "half a millimetre faced off afterwards", "pass", THREAD + with_tool(1, "G0 Z-0.5\nG0 X11\nG1 X-0.9 F200\nG0 Z5\n"))
    turned("turn-faced-8", "8 of 15 mm faced off afterwards, in two cuts", "no pass", THREAD + with_tool(1, "".join(f"G0 Z{z}\nG0 X11\nG1 X-0.9 F300\nG0 Z5\nG0 X12\n" for z in (-4, -8))))
    turned("turn-faced-before", "faced to the centre and chamfered before the thread", "pass", with_tool(1, "G0 X11 Z0\nG1 X-0.4 F150\nG0 Z5\nG0 X8.4\nG1 Z0.4 F150\nG1 X10.4 Z-1.6\n") + THREAD)
    turned("turn-crest-off", "the crests turned down to 19.0", "no pass", THREAD + with_tool(2, "G0 Z2\nG0 X9.5\nG1 Z-16 F200\n"), words="destroyed in line")
    turned("turn-crest-cleaned", "the crests turned to 19.80: within 6g", "pass", THREAD + with_tool(2, "G0 Z2\nG0 X9.9\nG1 Z-15 F200\n"))
    turned("turn-drilled-inside", "the threaded bar drilled to 14.5: 1.7 mm of wall", "pass", THREAD + with_tool(7, "G0 Z3\nG0 X0\nG1 Z-20 F120\nG0 Z5\n", s=600))
    bored = with_tool(7, "G0 Z3\nG0 X0\nG1 Z-20 F120\nG0 Z5\n", s=600)
    bore = lambda r: with_tool(8, f"G0 X{r} Z3\nG1 Z-18 F200\nG0 X{r - 0.5}\nG0 Z5\n").replace("G0 X30 Y0 Z10", "G0 X7 Y0 Z10").replace("G0 X30\nG0 Z50", "G0 Z50")
    turned("turn-bored-through", "the threaded bar bored to 18.6: roots open", "no pass", THREAD + bored + bore(8.2) + bore(9.3))
    turned("turn-wrong-flanks", "a 55 degree insert", "no pass", THREAD.replace("T4", "T9").replace("H4", "H9"))
    turned("turn-rapid-into-thread", "the next tool's rapid goes into the thread", "no pass", THREAD + with_tool(1, "G0 Z-8\nG0 X9.2\n"))
    turned("turn-spindle-at-rest", "G76 with the spindle at rest", "refused", THREAD.replace("S1000 M3", "M5"))
    fanuc_turned("turn-taper", "a taper thread by G32: its limits are not known", "no pass", "T0303\nG97 S800 M3\nG0 X24. Y0 Z5.\n" + "".join(
        f"G0 X{x:.3f}\nG32 X{x + 1.25:.3f} Z-15. F1.5\nG0 X24.\nZ5.\n" for x in (18.4, 17.9, 17.5, 17.3)) + "G0 X60. Z50.\n")
    fanuc_turned("turn-face-scroll", "a spiral on the face by G32 along X: not judged", "no pass", "T0303\nG97 S300 M3\nG0 X26. Y0 Z5.\nZ-0.4\nG32 X6. F2.\nG0 Z5.\nG0 X60. Z50.\n")
    turned("turn-hold", "a hold in the second pass, resumed", "pass", THREAD, options=LATHE + " --operator 'hold at 2.9s; resume at 4s'")
    turned("turn-spindle-override", "the spindle at 80 %", "pass", THREAD, options=LATHE + " --operator 'spindle-override 80 at 1s'")
    turned("turn-dropout", "the spindle's encoder silent for 5 ms in the second pass", "no pass", THREAD, options=LATHE + " --fault 'dropout 5ms at 3s'")
    turned("turn-zero-moved", "G54 moved by 0.3 along X: not the axis of the bar", "no pass", "G10 L2 P1 X-149.7\n" + THREAD)
    turned("turn-thread-then-smaller-diameter", "the threaded end turned away to 16", "no pass", THREAD + with_tool(1, "G0 Z2\nG0 X8\nG1 Z-16 F250\n"), words="destroyed in line")


def polygon_block(tool, across, r=0, z=-4, radius=50, d=" D0", inch=False, q=2):
    x = across / 2 + radius
    if inch:
        return f"""T{tool} M6
G43 H{tool}
G0 X{x / 25.4 + 0.8:.4f} Y0 Z0.2
M3 S500
G51.2 P1 Q{q} R{r}{d}
G0 X{x / 25.4:.5f} Z0.08
G1 Z{z / 25.4:.4f} F2
G0 X{x / 25.4 + 0.8:.4f}
G50.2
"""
    return f"""T{tool} M6
G43 H{tool}
G0 X80 Y0 Z5
M3 S500
G51.2 P1 Q{q} R{r}{d}
G0 X{x:.3f} Z2
G1 Z{z} F50
G0 X80
G50.2
"""


def part_polygons():
    head = "G21 G90 G94 G17\n"

    def polygon(name, story, expected, body, words=""):
        case(name, "polygon-lathe", LATHE, story, expected, f"%\n({name.replace('-', ' ')})\n{head}{body}M5\nG0 Z100\nM30\n%\n", words)

    hexagon = polygon_block(21, 19)
    turn = lambda radii, z=-6, tool=1: f"M5\nG18 G8\nT{tool} M6\nG43 H{tool}\nS1200 M3\nG0 X30 Y0 Z2\n" + "".join(f"G0 X{r}\nG1 Z{z} F250\nG0 X30\nG0 Z2\n" for r in radii) + "G17\n"
    down = lambda r: turn([21, 17, 13, 11, r])
    polygon("polygon-hex-19", "a hexagon of 19", "pass", hexagon)
    polygon("polygon-hex-r75", "a hexagon of 17 at R75", "pass", polygon_block(21, 17, r=75))
    polygon("polygon-square-r35", "a square of 28 at R35", "pass", polygon_block(22, 28, r=35))
    polygon("polygon-two-flats", "two flats of 20 by one insert", "pass", polygon_block(23, 20, radius=45))
    case("polygon-inch", "polygon-lathe", LATHE, "a hexagon of 3/4 inch", "pass", f"%\nG20 G90 G94 G17\n{polygon_block(21, 19.05, inch=True)}M5\nG0 Z4\nM30\n%\n")
    polygon("polygon-again-same", "the hexagon cut twice alike", "pass", hexagon + "M5\n" + hexagon)
    polygon("polygon-again-r120", "cut again at R120: the next insert on the same faces", "pass", hexagon + "M5\n" + polygon_block(21, 19, r=120))
    polygon("polygon-again-r20", "cut again at R20: faces 10 degrees beside", "no pass", hexagon + "M5\n" + polygon_block(21, 19, r=20))
    polygon("polygon-again-r60", "cut again at R60: faces where the corners were", "no pass", hexagon + "M5\n" + polygon_block(21, 19, r=60))
    polygon("polygon-rough-and-finish", "roughed at 19.4, finished at 19", "pass", polygon_block(21, 19.4) + "M5\n" + hexagon)
    polygon("polygon-rough-turned", "roughed at 21 and R20, finished at 17: whole within it", "pass", polygon_block(21, 21, r=20) + "M5\n" + polygon_block(21, 17))
    polygon("polygon-rough-corner", "roughed at 19 and R60, finished at 17: 19.0 is left across corners", "pass", polygon_block(21, 19, r=60) + "M5\n" + polygon_block(21, 17))
    polygon("polygon-square-over-hex", "a square of 17 over a hexagon of 17", "no pass", polygon_block(21, 17) + "M5\n" + polygon_block(22, 17))
    polygon("polygon-turned-away", "the hexagon of 17 turned to 18.4 afterwards", "no pass", polygon_block(21, 17) + turn([9.2], z=-3.5))
    polygon("polygon-corners-broken", "the corners of the hexagon of 17 turned to 19.5", "pass", polygon_block(21, 17) + turn([9.75], z=-3.5))
    polygon("polygon-bar-turned", "the bar turned to 19.5 before", "pass", down(9.75) + "M5\n" + polygon_block(21, 17))
    polygon("polygon-bar-too-thin", "the bar turned to 18 before: no corners", "no pass", down(9) + "M5\n" + polygon_block(21, 17))
    polygon("polygon-faced-off", "half of the hexagon faced off", "no pass", hexagon + "M5\nG18 G8\nT1 M6\nG43 H1\nS1000 M3\nG0 X30 Y0 Z5\nG0 Z-2\nG1 X-0.9 F400\nG0 Z5\nG17\n")
    polygon("polygon-groove", "a groove of 2 mm in the middle of the hexagon", "no pass", polygon_block(21, 17, z=-8) + "M5\nG18 G8\nT5 M6\nG43 H5\nS800 M3\nG0 X30 Y0 Z5\nG0 Z-4\nG1 X7 F200\nG0 X30\nG17\n")
    polygon("polygon-parted-behind", "parted off behind the hexagon", "pass", polygon_block(21, 17) + "M5\nG18 G8\nT5 M6\nG43 H5\nS800 M3\nG0 X30 Y0 Z5\nG0 Z-12\nG1 X-0.3 F300\nG0 X30\nG17\n")
    polygon("polygon-in-air", "the cutter stays a millimetre off the bar", "no pass", polygon_block(21, 52))
    polygon("polygon-zero-moved", "G54 moved by 0.2 along X: 0.4 across flats", "no pass", "G10 L2 P1 X-149.8\n" + hexagon)
    polygon("polygon-spindle-at-rest", "G51.2 with the work at rest", "refused", hexagon.replace("M3 S500", "M5"))
    polygon("polygon-after-m19", "the spindle oriented before", "pass", "S300 M3\nM5\nM19 R40\n" + hexagon)
    polygon("polygon-written-k", "the hexagon of 17 by a written K", "pass", polygon_block(21, 17, d=" K0.81"))


def part_gears():
    def gear(name, story, expected, body, words="", machine="gear-hobber"):
        case(name, machine, "--tools gears.toml", story, expected, body, words)

    def block(t=24, l=1, q="2", p="", x=56.5, tip=26.0, tool=1, z=-6, f=40, s=600, sense="M3", drawing="", bottom=-8, again="", enter=""):
        helix = f" P{p}" if p != "" else ""
        return f"""(STOCK X-{tip:g} Y-{tip:g} Z{bottom} X{tip:g} Y{tip:g} Z0)
G21 G17 G90 G94
{drawing}{enter}T{tool} M6
G43 H{tool}
G0 X110 Y0 Z5
{sense} S{s}
G81 T{t} L{l} Q{q}{helix}
G0 X{x}
G1 Z{z} F{f}
G0 X110
{again}G80
M5
M2
"""
    gear("gear-spur-24", "24 straight teeth of module 2", "pass", block())
    gear("gear-left-helix", "20 teeth, 15 degrees left hand, by a right-hand hob", "pass", block(t=20, p=-15, x=53.206, tip=22.706, f=50))
    gear("gear-shifted", "18 teeth with a profile shift of 0.3", "pass", block(t=18, x=51.1, tip=20.6, f=50, drawing="(GEAR SHIFT 0.3)\n"))
    gear("gear-shift-not-stated", "the same axes without the drawing's SHIFT: teeth 0.44 too thick", "no pass", block(t=18, x=51.1, tip=20.6, f=50))
    gear("gear-two-starts", "24 teeth by a hob of two starts, L2", "pass", block(l=2, x=61.5, tool=3, f=80))
    gear("gear-two-starts-as-one", "the hob of two starts, ordered as one", "no pass", block(l=1, x=61.5, tool=3))
    case("gear-pitch-inch", "gear-hobber", "--tools gears.toml", "24 teeth of 12 diametral pitch, in inches", "pass", """G20 G17 G90 G94
(STOCK X-1.08333 Y-1.08333 Z-0.32 X1.08333 Y1.08333 Z0)
T5 M6
G43 H5
G0 X4.3 Y0 Z0.2
M3 S600
G81 T24 L1 Q12
G0 X2.27083
G1 Z-0.24 F1.6
G0 X4.3
G80
M5
M2
""")
    gear("gear-rough-and-finish", "roughed 0.4 shallow, finished in the same gear train", "pass", block(x=56.9, again="G0 Z5\nG0 X56.5\nG1 Z-6\nG0 X110\n"))
    gear("gear-rough-only", "roughed 0.4 shallow, never finished", "no pass", block(x=56.9))
    gear("gear-width", "a face of 5 mm asked, 6 cut", "pass", block(drawing="(GEAR WIDTH 5)\n"))
    gear("gear-width-short", "a face of 7.5 mm asked, 4 cut", "no pass", block(z=-4, drawing="(GEAR WIDTH 7.5)\n", f=30))
    gear("gear-too-deep", "0.4 too deep", "no pass", block(x=56.1))
    gear("gear-in-air-x", "the hob stays at X110", "no pass", block(x=110))
    gear("gear-in-air-z", "the hob stops above the blank", "no pass", block(z=2))
    gear("gear-one-tooth-less", "23 teeth at the distance of 24", "no pass", block(t=23))
    gear("gear-wrong-hob", "the hob of module 2.5 for module 2", "no pass", block(tool=2))
    gear("gear-wrong-module", "module 2.5 ordered with the hob of 2", "no pass", block(q="2.5", t=20, x=57.5, tip=27.5))
    gear("gear-wrong-hand", "a left-hand hob with L1", "no pass", block(tool=4))
    gear("gear-left-hob", "a left-hand hob with L-1", "pass", block(tool=4, l=-1))
    gear("gear-backwards", "the hob turns backwards", "no pass", block(sense="M4"))
    gear("gear-blank-small", "the blank is 1.5 mm too small in radius: tips missing", "no pass", block(tip=24.5))
    gear("gear-blank-large", "the blank is 1.5 mm too large in radius: tips too high", "no pass", block(tip=27.5))
    gear("gear-other-helix-over", "15 degrees over straight teeth", "no pass", block(again="G80\nG0 Z5\nG81 T24 L1 Q2 P15\nG0 X57.347\nG1 Z-6\nG0 X110\n"))
    gear("gear-other-number-over", "25 teeth over 24 at the distance of 24", "no pass", block(again="G80\nG0 Z5\nG81 T25 L1 Q2\nG0 X56.5\nG1 Z-6\nG0 X110\n"))
    gear("gear-wrong-angle", "a hob of 15 degrees where 20 are asked", "no pass", block(tool=6))
    gear("gear-angle-stated", "the hob of 15 degrees, ANGLE 15 on the drawing", "pass", block(tool=6, drawing="(GEAR ANGLE 15)\n"))
    gear("gear-span-missed", "a span 20 to 40 µm below the nominal asked, cut to the nominal", "no pass", block(drawing="(GEAR SPAN -0.04 -0.02)\n"))
    gear("gear-span-met", "the same span, 44 µm deeper", "pass", block(x=56.456, drawing="(GEAR SPAN -0.04 -0.02)\n"))
    gear("gear-one-pass", "fed 9 mm a turn of the work: not each tooth is cut three times", "no pass", block(f=225))
    gear("gear-zero-moved", "G54 moved by 0.3 along X", "no pass", block(enter="G10 L2 P1 X-149.7\n"))
    gear("gear-spindle-at-rest", "G81 with the hob at rest", "refused", block(sense="M5"))


def part_cams():
    def cam(name, story, expected, body, options="", words="", dialect=""):
        case(name, "cam-grinder", f"{dialect} {options}".strip(), story, expected, body, words)

    measure = lambda p, s=30, r=0, z=-20: f"G0 X248 Z{z}\nG151 P{p} R{r}\nG152\nG153\nG154 S{s} P2\nG155\n"
    grind = lambda p, s=30, r=0, z=-20: f"G0 X248 Z{z}\nG151 P{p} R{r}\nG150\nG154 X-0.1 F0.05 S{s}\nG154 P3\n"
    body = lambda *parts: "G21 G90 G54\n" + "".join(parts) + "G151 P0\nM30\n"
    cam("cam-eccentric", "an eccentric at 45 degrees", "pass", body(measure(1234, r=45), grind(1234, r=45)))
    cam("cam-lobes", "three lobes", "pass", body(measure(1236), grind(1236)))
    cam("cam-again-same", "the eccentric ground twice alike", "pass", body(measure(1234), grind(1234), grind(1234)))
    cam("cam-again-turned", "the eccentric ground again, turned by 90 degrees", "no pass", body(measure(1234), grind(1234), grind(1234, r=90)))
    cam("cam-again-turned-little", "ground again, turned by 5 degrees", "no pass", body(measure(1234), grind(1234), grind(1234, r=5)))
    cam("cam-other-over", "the harmonic ground over the eccentric", "no pass", body(measure(1234), measure(1235), grind(1234), grind(1235)))
    cam("cam-lobes-symmetric", "three lobes ground again, turned by 120 degrees: the same lobes", "pass", body(measure(1236), grind(1236), grind(1236, r=120)))
    cam("cam-two-places", "two eccentrics, 40 mm apart, at 0 and 90 degrees", "pass", body(measure(1234), grind(1234), grind(1234, r=90, z=-60)))
    cam("cam-overlap", "two eccentrics 4 mm apart with a wheel of 10: the second grinds into the first", "no pass", body(measure(1234), grind(1234), grind(1234, r=90, z=-24)))
    cam("cam-late", "nothing fed forward, nothing compensated: late by three times a degree", "no pass", body("G0 X248 Z-20\nG151 P1234\nG154 X-0.1 F0.05 S60\nG154 P3\n"), options="--feed-forward off")
    cam("cam-wrong-sign", "compensated with the wrong sign", "no pass", body(measure(1234), grind(1234)), options="--feed-forward off --compensation wrong")
    cam("cam-not-measured", "compensation ordered, nothing measured", "refused", body(grind(1234)))
    cam("cam-toyoda", "an eccentric by Toyoda's words", "pass", "N10 G00 X240\nN20 G51 P1234\nN30 G52\nN40 G53 G04 S20 P2\nN50 G55\nN60 G50\nN70 G01 X-0.1 F0.1 R0.1 S20\nN80 G04 S20 P2\nN90 M30\n", dialect="--dialect toyoda")


def part_unknown_tools():
    """Tools of which the table does not say what they leave: their diameter is all that is known."""
    g1 = lambda **w: ("G1", w)
    g0 = lambda **w: ("G0", w)
    holes("other-across-thread", "linuxcnc", "a tool of kind other fed across the finished M8, 5 deep", "no pass", M8 + [mill(31, 3000, 300, [g0(X=-20, Y=0), g0(Z=2), g1(Z=-5), g1(X=20), g0(Z=20)])], words="not known")
    holes("other-across-thread-inch", "fanuc-inch", "the same from a post that writes inches, along Y", "no pass", M8 + [mill(31, 3000, 300, [g0(X=0, Y=-20), g0(Z=2), g1(Z=-5), g1(Y=20), g0(Z=20)])], words="not known")
    holes("other-over-thread-in-air", "linuxcnc", "fed across 5 mm above the finished M8", "pass", M8 + [mill(31, 3000, 300, [g0(X=-20, Y=0), g0(Z=5), g1(X=20), g0(Z=20)])])
    holes("other-beside-block", "haas", "fed down beside the block", "pass", M8 + [mill(31, 3000, 300, [g0(X=210, Y=0), g0(Z=5), g1(Z=-5), g1(X=230), g0(Z=20)])], machine="tapping-center")
    holes("other-in-hole", "linuxcnc", "a brush of 6 in the middle of the hole of 6.8, not below its cylinder", "pass", [drill(11, ONE, -24), mill(31, 3000, 300, [g0(X=0, Y=0), g0(Z=5), g1(Z=-15), g1(Z=5), g0(Z=20)]), tap(20, ONE, -18)])
    holes("other-in-thread", "haas", "a brush of 6 in the middle of the finished M8: within its minor diameter", "pass", M8 + [mill(31, 3000, 300, [g0(X=0, Y=0), g0(Z=5), g1(Z=-12), g1(Z=5), g0(Z=20)])])
    holes("other-orbit-in-thread", "linuxcnc", "it goes around in the finished M8, 0.8 off its axis: into the flanks", "no pass", M8 + [ring(31, 0, 0, 0.8, -8, s=3000, f=200)], words="not known")
    holes("other-orbit-free", "linuxcnc", "it goes around in the finished M8, 0.3 off its axis: free of the flanks", "pass", M8 + [ring(31, 0, 0, 0.3, -8, s=3000, f=200)])
    holes("other-slot-far", "mitsubishi", "a slot of unknown form 25 beside the M8", "no pass", M8 + [slot(31, (25, -10), (25, 10), -3, s=3000, f=300)], words="not known")
    holes("other-by-cycle", "linuxcnc", "a hole by G81 with a tool of kind other beside a drilled one", "no pass", [drill(11, ONE, -20), drill(31, [(20, 0)], -10, s=800, f=100)], words="not known")
    holes("other-reams", "fanuc", "a hole of 5.8 opened to 6 by a tool of kind other", "no pass", [drill(29, ONE, -18), drill(31, ONE, -12, cycle="G85", s=800, f=150)], words="not known")
    holes("other-before-tap", "linuxcnc", "a thread milled by a tool of kind other, then tapped over: the flanks are not known", "no pass", [drill(11, ONE, -24), ring(31, 0, 0, 0.9, -12, s=3000, f=200), tap(20, ONE, -18)])
    holes("tap-fed-by-g1", "linuxcnc", "the tap fed into its hole by G1, without its cycle", "no pass", [drill(11, ONE, -24), mill(20, 200, 250, [g0(X=0, Y=0), g0(Z=5), g1(Z=-15), g1(Z=5), g0(Z=20)])])
    holes("drill-as-mill", "linuxcnc", "the drill of 6.8 fed sideways through solid", "no pass", [mill(11, 2000, 300, [g0(X=0, Y=0), g0(Z=5), g1(Z=-5), g1(X=20), g0(Z=20)])])
    across = lambda z: [g0(X=-20, Y=0), g0(Z=2), g1(Z=z), g1(X=20), g0(Z=20)]
    for_passes = lambda *zs, tool=3: [mill(tool, 4000, 500, [m for z in zs for m in across(z)])]
    holes("mill-passes-shallow-summed", "linuxcnc", "four passes of 0.09 over the finished M8, each deeper", "no pass", M8 + for_passes(-0.09, -0.18, -0.27, -0.36), words="destroyed in line")
    holes("mill-passes-shallow-inch", "haas-inch", "the same in inches, by two mills in turn", "no pass", M8 + for_passes(-0.09, -0.18) + for_passes(-0.27, -0.36, tool=2), words="destroyed in line")
    holes("mill-passes-same-depth", "fanuc", "four passes 0.09 deep, all at one depth", "pass", M8 + for_passes(-0.09, -0.09, -0.09, -0.09))
    holes("mill-chamfers-summed", "linuxcnc", "a chamfer mill over the M8 in four passes, in the end 3.5 deep at the core hole", "no pass", M8 + [ring(6, 0, 0, 1.0, z) for z in (-3.5, -4.5, -5.2, -5.95)], words="destroyed in line")
    holes("mill-faces-below-zero", "linuxcnc", "faced three times by 0.09 under a thread of 13: 0.27 gone", "no pass", M8 + [face(-0.09), face(-0.18), face(-0.27)], words="destroyed in line")


def part_crossing_chains():
    """G33 that goes back over its thread, tapers, and what lies beside them."""
    PASSES = ("9.65", "9.38", "9.2", "9.08", "9.015")
    head = "T4 M6\nG43 H4\nS900 M3\nG0 X12 Y0 Z6\n"
    last = "".join(f"G0 X{x}\nG33 Z-16 K1.5\nG0 X12\nG0 Z6\n" for x in PASSES[:-1]) + "G0 X9.015\nG33 Z-16 K1.5\n"
    turned("back-same-sense", "the last pass goes back in the groove, the spindle turning on: a crossing helix", "no pass", head + last + "G4 P0.4\nG33 Z6 K1.5\nG0 X12\n", words="cut across")
    turned("back-each-pass", "every pass is cut on the way back, too", "no pass", head + "".join(f"G0 X{x}\nG33 Z-16 K1.5\nG4 P0.4\nG33 Z6 K1.5\n" for x in PASSES) + "G0 X12\n", words="cut across")
    turned("back-in-chain", "forth and back in one chain without a stop", "no pass", head + "".join(f"G0 X{x}\nG33 Z-16 K1.5\nG33 Z6 K1.5\n" for x in PASSES) + "G0 X12\n", words="cut across")
    turned("back-in-chain-inch", "the same in inches, 16 threads an inch: forth and back", "no pass", "G20\n" + "T4 M6\nG43 H4\nS900 M3\nG0 X0.5 Y0 Z0.3\n" + "".join(f"G0 X{x}\nG33 Z-0.6 K0.0625\nG33 Z0.3 K0.0625\n" for x in ("0.36", "0.35", "0.34")) + "G0 X0.5\nG21\n", words="cut across")
    turned("back-in-air", "each pass goes back by G33 with the insert clear of the bar", "pass", head + "".join(f"G0 X{x}\nG33 Z-16 K1.5\nG0 X12\nG33 Z6 K1.5\n" for x in PASSES))
    turned("back-other-lead", "back over the thread with another lead", "no pass", head + last + "G4 P0.4\nG33 Z6 K2\nG0 X12\n", words="cut across")
    turned("back-fine-scratch", "back over it 0.1 above its root: the flanks are crossed", "no pass", head + last + "G0 X9.115\nG33 Z6 K1.5\nG0 X12\n", words="destroyed in line")
    turned("back-m4", "left-hand by M4, away from the chuck by M4 again: a right-hand helix over the left-hand one", "no pass", head.replace("M3", "M4") + last + "G4 P0.4\nG33 Z6 K1.5\nG0 X12\n", words="cut across")
    turned("away-from-chuck", "M4 and every pass away from the chuck: right-hand, begun in a relief groove", "pass", with_tool(5, "G0 Z-18\nG0 X11\nG1 X8.6 F60\nG0 X12\nG0 Z-16.5\nG0 X11\nG1 X8.6 F60\nG0 X12\nG0 Z-21\nG0 X11\nG1 X8.6 F60\nG0 X12\nG0 Z-19.5\nG0 X11\nG1 X8.6 F60\nG0 X12\n", s=800) + "T4 M6\nG43 H4\nS600 M4\nG0 X12 Y0 Z-18.5\n" + "".join(f"G0 X{x}\nG33 Z4 K1.5\nG0 X12\nG0 Z-18.5\n" for x in PASSES))
    taper = lambda xs, run, z=-15, lead=1.5: "".join(f"G0 X{x:.3f}\nG32 X{x + run:.3f} Z{z}. F{lead}\nG0 X24.\nZ5.\n" for x in xs)
    fan = lambda tool: f"T{tool:02}{tool:02}\nG97 S800 M3\nG0 X24. Y0 Z5.\n"
    home = "G0 X60. Z50.\n"
    fanuc_turned("taper-two-inserts", "a taper thread roughed by one insert, finished by another: one thread, not judged, and not said to cut across itself", "no pass", fan(10) + taper((18.4, 17.9), 1.25) + home + fan(3) + taper((17.5, 17.3), 1.25) + home, words="!cut across")
    fanuc_turned("taper-by-g92", "a taper by G92 R: not judged, with the reason", "no pass", fan(3) + "G92 X19.2 Z-15. R-0.625 F1.5\nX18.8\nX18.5\nX18.3\n" + home, words="taper")
    fanuc_turned("taper-by-g76", "a taper by G76 R: not judged, with the reason", "no pass", fan(3) + "G76 P010060 Q100 R0.03\nG76 X18.3 Z-15. R-0.625 P920 Q300 F1.5\n" + home, words="taper")
    fanuc_turned("taper-in-air", "a taper 3 mm off the bar: not cut", "no pass", fan(3) + taper((26.4, 25.9), 1.25) + home, words="not cut")
    fanuc_turned("taper-over-straight", "a taper thread over the finished straight one", "no pass", fan(4) + "".join(f"G0 X{x}\nG32 Z-15. F1.5\nG0 X24.\nZ5.\n" for x in ("19.3", "18.76", "18.4", "18.16", "18.03")) + taper((17.6,), 1.0) + home)
    fanuc_turned("taper-hardly", "a straight thread whose end is half a micrometre off: straight as far as axes go", "pass", fan(4) + "".join(f"G0 X{x:.3f}\nG32 X{x + 0.0008:.4f} Z-15. F1.5\nG0 X24.\nZ5.\n" for x in (19.3, 18.76, 18.4, 18.16, 18.03)) + home)
    fanuc_turned("taper-then-turned-away", "the taper thread is turned away: still no pass", "no pass", fan(3) + taper((18.4, 17.9, 17.5, 17.3), 1.25) + home + "T0101\nG97 S800 M3\nG0 X22. Z2.\nX15.\nG1 Z-16. F0.2\nG0 X24.\n" + home)


def part_inserts_before_motion():
    """What an insert's edges meet is known before motion."""
    groove = lambda z, x: f"G0 Z{z}\nG0 X11\nG1 X{x} F60\n"
    turned("edge-left-of-groove", "a rapid of the grooving insert, 1.5 mm to the left of its own groove", "refused", with_tool(5, groove(-20, 8) + "G0 X12\nG0 Z-21.5\nG0 X9\n", s=800))
    turned("edge-right-of-groove", "a rapid of the grooving insert, 1 mm to the right of its own groove: its right half goes into solid", "refused", with_tool(5, groove(-20, 8) + "G0 X12\nG0 Z-19\nG0 X9\n", s=800))
    turned("edge-in-own-groove", "a rapid into its own groove and out again, then the thread before it", "pass", with_tool(5, groove(-20, 8) + "G0 X12\nG0 X8.4\nG0 X12\n", s=800) + THREAD)
    turned("edge-at-shoulder", "turned to a shoulder, out along it by a rapid, and back in by a rapid", "pass", with_tool(1, "G0 Z2\nG0 X9.9\nG1 Z-30 F250\nG0 X12\nG0 Z2\nG0 X9.91\nG0 Z-29.9\nG0 X12\n") + THREAD)
    turned("edge-into-shoulder", "a rapid 0.6 mm beyond the shoulder that was turned", "refused", with_tool(1, "G0 Z2\nG0 X8\nG1 Z-30 F150\nG0 X12\nG0 Z2\nG0 X8.05\nG0 Z-30.6\nG0 X12\n"))
    turned("edge-trailing", "behind a shoulder the insert of 80 degrees where that of 35 has turned a neck: its edge meets the flank", "refused", with_tool(2, "G0 Z-10\nG0 X10.5\nG1 X7 Z-20 F100\nG1 Z-24\nG0 X12\n") + with_tool(1, "G0 Z-22\nG0 X7.1\nG0 X12\n"))
    turned("edge-trailing-same", "the same neck and the insert of 35 degrees that has turned it, then a thread before the neck", "pass", with_tool(2, "G0 Z-10\nG0 X10.5\nG1 X7 Z-20 F100\nG1 Z-24\nG0 X12\nG0 Z-22\nG0 X7.1\nG0 X12\n") + THREAD.replace("Z-15", "Z-8"))
    turned("edge-faced-and-back", "faced past the middle and off by a rapid along Z, then the thread", "pass", with_tool(1, "G0 X11 Z-0.5\nG1 X-0.9 F150\nG0 Z5\n") + THREAD)
    turned("edge-chamfer-retract", "a chamfer of 1 mm, away by a rapid across, then the thread", "pass", with_tool(2, "G0 X8.5 Z1\nG1 X10.5 Z-1 F100\nG0 X12\n") + THREAD)


for part in (part_good_posts, part_feeds, part_frames, part_holes, part_mills, part_faults, part_turning, part_polygons, part_gears, part_cams, part_unknown_tools, part_crossing_chains,
             part_inserts_before_motion):
    part()

for old in HERE.glob("*.ngc"):
    old.unlink()
REMARKS = {
    "feed-m8-1122": "expectation corrected after the first run: 1122/900 is 1.25 in three digits, as the lead",
    **dict.fromkeys(("frame-g68-quarter", "frame-g68-eighth", "frame-g68-both", "frame-mirror-symmetric", "frame-mirror-lopsided",
                     "frame-mirror-both", "frame-scaled-tap"), "program corrected after the first run: G54 may not stand beside a frame that is in force"),
    **dict.fromkeys(("fault-dropout", "fault-slip", "fault-power-cut", "fault-fast-dropout"),
                    "program corrected after the first run: its moment lay in the drilling"),
    "fault-feedback-lost": "expectation corrected after the first run: two periods are bridged, and the thread is good",
    "turn-left-hand-unasked": "expectation corrected after the first run: it is said before motion, and a left-hand thread can be meant",
    "turn-chain-two-leads": "expectation corrected after the first run: a lead that changes is ordered and cut so, as a feed screw's",
    "polygon-turned-away": "program corrected after the first run: the insert ran into the bar's full diameter",
    "back-fine-scratch": "words corrected after the first run: the first thread is said to be destroyed by the line of the second",
    "taper-two-inserts": "program corrected after the first run: its tool number was none",
    "polygon-rough-corner": "expectation corrected after the first run: 19.0 across corners are 1.13 of the least width, 16.73",
}
TABLE = HERE.parent / "attacks.tsv"
# verdicts of the judge that looked at each feature alone are kept: they cannot be made again here
before = {line.split("\t")[0]: line.split("\t")[6] for line in TABLE.read_text().splitlines()[1:]} if TABLE.exists() else {}
rows = []
for name, machine, options, story, expected, words, text in CASES:
    assert re.fullmatch(r"[a-z0-9.-]+", name), name
    (HERE / f"{name}.ngc").write_text(text)
    rows.append("\t".join((name, machine, options, story, expected, words, before.get(name, ""), REMARKS.get(name, ""))))
TABLE.write_text("name\tmachine\toptions\twhat happens to the part\texpected\tsays\tbefore\tremark\n" + "\n".join(rows) + "\n")
counts = {kind: sum(1 for c in CASES if c[4] == kind) for kind in ("pass", "no pass", "refused")}
print(len(CASES), counts)
