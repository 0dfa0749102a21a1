"""Posts that write the same operations as different systems do: used by generate.py.

Operations are in millimetres about G54; a post chooses unit, words, order and cycles.

    ("drill", tool, points, z, {r, cycle, q, s, f})      ("tap", tool, points, z, {r, s, a, hand})
    ("mill", tool, s, f, [(code, {X:, Y:, Z:, I:, J:}), ...])      ("raw", text)
"""
LEAD = {17: 0.7, 18: 0.8, 19: 1.0, 20: 1.25, 21: 1.75, 22: 1.27, 23: 1.5875, 24: 1.0, 25: 1.0, 26: 1.5, 32: 1.0, 33: 1.0}


def num(value, digits, point):
    """A number in a post's spelling."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    if text in ("", "-0"):
        text = "0"
    return text + ("." if point and "." not in text else "")


class Post:
    """A post: unit, spelling and habits."""

    def __init__(self, kind):
        self.kind = kind
        self.inch = kind.endswith("inch")
        self.family = kind.split("-")[0]
        self.point = self.family != "linuxcnc"
        self.lines = []
        self.n = 0

    def v(self, mm):
        return num(mm / 25.4 if self.inch else mm, 4 if self.inch else 3, self.point)

    def f(self, mm):
        return num(mm / 25.4 if self.inch else mm, 4 if self.inch else 2, self.point)

    def put(self, text):
        if self.family == "fanuc":
            self.n += 10
            text = f"N{self.n} {text}"
        elif self.family == "haas":
            self.n += 1
            text = f"N{self.n} {text}"
        self.lines.append(text)

    def words(self, words):
        return " ".join(f"{letter}{self.v(value)}" for letter, value in words.items())

    def call(self, tool, s, sense="M3", first=None):
        x, y = first if first else (0, 0)
        place = f"X{self.v(x)} Y{self.v(y)}"
        if self.family == "linuxcnc":
            self.put(f"T{tool} M6")
            self.put(f"G43 H{tool}")
            if s:
                self.put(f"S{s} {sense}")
            self.put(f"G0 {place} Z{self.v(20)}")
        elif self.family == "fanuc":
            self.put(f"T{tool:02} M06")
            self.put(f"G90 G54 G00 {place}" + (f" S{s} {sense.replace('M', 'M0')}" if s else ""))
            self.put(f"G43 H{tool:02} Z{self.v(20)} M08")
        elif self.family == "haas":
            self.put(f"T{tool} M06")
            self.put(f"G00 G90 G54 {place}")
            if s:
                self.put(f"S{s} {sense.replace('M', 'M0')}")
            self.put(f"G43 Z{self.v(20)} H{tool}")
        else:  # mitsubishi
            self.put(f"T{tool} M6")
            self.put(f"G0 G90 G54 {place}")
            self.put(f"G43 Z{self.v(20)} H{tool}" + (f" S{s} {sense}" if s else ""))

    def cycle(self, head, points, tail):
        x, y = points[0]
        self.put(f"{head} X{self.v(x)} Y{self.v(y)} {tail}")
        for (x, y), (px, py) in zip(points[1:], points):
            words = [f"X{self.v(x)}"] if x != px else []
            words += [f"Y{self.v(y)}"] if y != py or not words else []
            self.put(" ".join(words))
        self.put("G80")

    def drill(self, tool, points, z, o):
        self.call(tool, o.get("s", 2500), first=points[0])
        cycle = o.get("cycle", "G81")
        tail = f"Z{self.v(z)} R{self.v(o.get('r', 2))}"
        if o.get("q"):
            tail += f" Q{self.v(o['q'])}"
        tail += f" F{self.f(o.get('f', 500))}"
        self.cycle(f"G98 {cycle}" if o.get("g98") else f"G99 {cycle}", points, tail)

    def tap(self, tool, points, z, o):
        lead, s = LEAD[tool], o.get("s", 1500)
        left = o.get("left", tool == 25)
        code = "G74" if left else "G84"
        rigid = self.family == "fanuc" and o.get("m29", True)
        self.call(tool, None if rigid else s, sense="M4" if left else "M3", first=points[0])
        if rigid:
            self.put(f"M29 S{s}")
        f = o.get("f", s * lead)
        tail = f"Z{self.v(z)} R{self.v(o.get('r', 5))}"
        if o.get("q"):
            tail += f" Q{self.v(o['q'])}"
        if o.get("g95"):
            self.put("G95")
            tail += f" F{num(lead / 25.4 if self.inch else lead, 5, self.point)}"
        else:
            tail += f" F{self.f(f)}"
        if self.family == "mitsubishi" and o.get("rigid", True):
            tail += " ,R1"
        self.cycle(f"G98 {code}" if o.get("g98") else f"G99 {code}", points, tail)
        if o.get("g95"):
            self.put("G94")

    def mill(self, tool, s, f, moves, sense="M3"):
        first = (moves[0][1].get("X", 0), moves[0][1].get("Y", 0))
        self.call(tool, s, sense=sense, first=first)
        fed = False
        for code, words in moves:
            text = f"{code} {self.words(words)}"
            if code != "G0" and not fed:
                text, fed = text + f" F{self.f(f)}", True
            self.put(text)
        self.put(f"G0 Z{self.v(20)}")

    def program(self, ops, title, head=None):
        unit = "G20" if self.inch else "G21"
        self.lines = [] if self.family == "linuxcnc" else ["%"]
        if self.family == "linuxcnc":
            self.lines.append(f"({title})")
            self.put(f"{unit} G17 G40 G49 G80 G90 G94 G54")
        else:
            self.lines.append(f"O{sum(map(ord, title)) % 9000 + 100:04} ({title.upper()})")
            self.put(f"{unit} G17 G40 G49 G80 G90 G94")
        for line in head or []:
            self.lines.append(line)
        for op, *rest in ops:
            if op == "raw":
                for line in rest[0].strip("\n").split("\n"):
                    self.put(line)
            else:
                getattr(self, op)(*rest)
        if self.family == "linuxcnc":
            self.lines += ["G0 Z50 M5" if not self.inch else "G0 Z2 M5", "M2"]
        else:
            self.put("M05")
            self.put("G91 G28 Z0." if self.point else "G91 G28 Z0")
            self.lines += ["M30", "%"]
        return "\n".join(self.lines) + "\n"
