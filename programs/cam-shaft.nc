(A shaft with four cams, each at its angle: measured in the air, then ground and sparked out)
(leadscrew run cam-shaft.nc --machine cam-grinder)
G21 G90 G54
(phase error of the profile at the speed of grinding)
G0 X248 Z-20
G151 P1237
G152
G153
G154 S60 P2
G155
(cylinder 1)
G151 P1237 R0
G150
G154 X-0.1 F0.05 S60
G154 P3
(cylinder 3)
G0 X248 Z-100
G151 P1237 R90
G150
G154 X-0.1 F0.05
G154 P3
(cylinder 4)
G0 X248 Z-140
G151 P1237 R180
G150
G154 X-0.1 F0.05
G154 P3
(cylinder 2)
G0 X248 Z-60
G151 P1237 R270
G150
G154 X-0.1 F0.05
G154 P3
G151 P0
M30
