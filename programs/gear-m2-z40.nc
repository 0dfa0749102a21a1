%
(helical gear, module 2, 40 teeth, 20 degrees right hand, 20 mm wide; machine gear-hobber)
(X is the distance of the axes of hob and work: half the root circle and half the hob)
(GEAR WIDTH 20)
G21 G90 G94 G17
T23 M6
G43 H23
G0 X110 Y0 Z5
M3 S300
G81 T40 L1 Q2 P20     (40 teeth, 1 start, module 2, helix 20 degrees: the work follows the hob, and Z)
G0 X75.067
G1 Z-25 F15           (2 mm a turn of the work)
G0 X110
G80
M5
G0 Z100
M30
%
