@500000.0,4600000.0,1200.0,32,0.0;
&WGS 1984;
!GeVotSCXPL;  / settings
[Burrow;
#bare-burrow.dat,A1[F,1640420.0,15091864.0,4000.0];
#shaft.dat,
 A5, B3; / shared /
];
