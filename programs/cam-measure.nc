(Phase error of profile 1234 at 10 rpm, in the air: JPH0622778B2, figure 8)
(leadscrew run cam-measure.nc --machine cam-grinder --dialect toyoda --phase-table phases.toml)
N100 G00 X240
N110 G51 P1234
N120 G52
N130 G53 G04 S10 P2
N140 G55
N150 M30
