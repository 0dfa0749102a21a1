%
(hexagon, 17 mm across flats, 20 mm long, from a bar; machine polygon-lathe)
(X is the distance of the two spindles' axes: half the flats and the cutter's tip radius)
G21 G90 G94 G17
T21 M6
G43 H21
G0 X75 Y0 Z5
M3 S500
G51.2 P1 Q2 R45 K0.2     (two turns of the cutter for one of the work; D0: the control chooses what swings)
G0 X58.5 Z2
G1 Z-20 F50
G0 X75
G50.2
M5
G0 Z100
M30
%
