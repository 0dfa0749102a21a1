%
(Six holes 8.5 in a row, chips thrown off on the way after the second, fourth and sixth)
(Run with --dialect brother --material AlSi; --dialect may be left out on a machine whose file says control.dialect = "brother")
(Heights count from the work table: 450 initial level, 400 upper face of the plate, 360 lower face)
G10 L2 P2 X-250 Y-200 Z-700
T5 M6
G43 H5
G55
G90 G00 X0 Y0 Z450. M03 S5000
G91 G81 X-10. Y-10. Z-90. R-50. P2. F3000. U2000 K6 E2
M30
%
