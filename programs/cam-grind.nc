(Grind profile 1234 with its phase error compensated: JPH0622778B2, figure 9)
(leadscrew run cam-grind.nc --machine cam-grinder --dialect toyoda --phase-table phases.toml)
N000 G00 X240
N010 G51 P1234
N020 G50
N030 G01 X-0.1 F0.1 R0.1 S10
N040 G04 S10 P2
N050 M30
