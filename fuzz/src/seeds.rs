//! Writes small pictures of every kind, and texts with every command, into `corpus/`, for each target.

#[path = "../../plotter-vector/tests/all/file_rows/pictures.rs"]
mod pictures;

fn main() -> std::io::Result<()> {
    let corpus = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    for target in ["image_to_drawing", "rows"] {
        let folder = corpus.join(target);
        std::fs::create_dir_all(&folder)?;
        for (number, (_, bytes)) in pictures::every_kind(9, 6).into_iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{number:03}")), bytes)?;
        }
    }
    let folder = corpus.join("metadata");
    std::fs::create_dir_all(&folder)?;
    let exif = [
        pictures::Exif { orientation: 6, ..Default::default() },
        pictures::Exif { resolution: Some(([(300, 1); 2], 2)), lens: true, orientation: 8 },
    ];
    let mut seeds: Vec<Vec<u8>> = Vec::new();
    for exif in exif {
        // In a JPEG, a PNG and a WebP.
        seeds.extend([0, 3, 5].map(|kind| [&[kind], &exif.bytes()[..]].concat()));
    }
    seeds.push([&[1][..], b"\x01\x02\x01\x01\x2c\x01\x2c\0\0"].concat());
    seeds.push([&[4][..], &[0, 0, 0x2e, 0x23, 0, 0, 0x2e, 0x23, 1]].concat());
    seeds.extend(pictures::with_metadata(9, 6).into_iter().map(|(_, bytes)| [&[7], &bytes[..]].concat()));
    for (number, seed) in seeds.into_iter().enumerate() {
        std::fs::write(folder.join(format!("seed-{number:03}")), seed)?;
    }
    let all = [
        ("hpgl", &HPGL[..]),
        ("cutters", &CUTTERS),
        ("gcode", &GCODE),
        ("svg", &SVG),
        ("dxf", &DXF),
        ("log", &LOGS),
        ("import", &RECORDINGS),
    ];
    for (target, texts) in all {
        let folder = corpus.join(target);
        std::fs::create_dir_all(&folder)?;
        for (number, text) in texts.iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{number:03}")), text)?;
        }
    }
    Ok(())
}

/// A log with every kind of record.
const LOGS: [&[u8]; 2] = [
    b"plotter-log 1 {\"baud\":256000,\"sum\":\"30\"}\n0 > 03 09 09 02 00 05 05 09 03 01 *89\n10312 < 31 33 31 *87\n\
        10350 @ edge x+ *5a\n10351 @ drive x 20 *04\n",
    include_bytes!("../../plotter-replay/tests/golden/line.plog"),
];

/// A recording of every tool, each behind the byte that chooses how it is imported.
const RECORDINGS: [&[u8]; 8] = [
    b"\x00> 2026/01/15 10:00:00.000000352  length=3 from=0 to=2\n 00 02 2b   ..+\n--\n",
    b"\x012006-05-30 13:23:49.461075: /dev/ttyS0\n00 31 2B   .1+\n2006-05-30 13:23:49.462: b\n01000010\n",
    b"\x02(1436509052.249713) host 0200\n(2.5) can0  TX - -  123   [2]  31 2B\n(3.5) x 044#2A\n",
    b"\x13Time [s],Value,Parity Error,Framing Error\n-0.1,'2',,\n0.2,0x31,,Error\n0.3,,,,\n0.4,\\n,,\n",
    b"\x03name,type,start_time,duration,data\n\"a\",\"data\",0.1,0.00004,0x02\nb,data,2021-04-27T14:54:31.3Z,,49\n",
    b"\x14109-189 uart-1: 02\nuart-1: Stop bit\n209-289 uart-1: [0A]\n300-310 uart-1: Frame error\n",
    b"\x15\x02\x00\x05131+",
    b"\x06# plotter-raw/1 name=x\n0,H,00\n39,D,3132\n78,H,",
];

/// Every kind of thing that is read of an SVG file, behind the byte that chooses how.
const SVG: [&[u8]; 4] = [
    b"\x01<svg xmlns='http://www.w3.org/2000/svg' width='9mm' height='9mm' viewBox='0 0 9 9'><style>.a{stroke:var(--b,red);transform:\
      rotate(1rad)}</style><path class='a' d='M0 0h9a2 2 0 0 1 3 3q1 1 2 0t2 0c1 1 2 2 3 0s1 1 2 2z' stroke-dasharray='2 1'/></svg>",
    b"\x04<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><clipPath id='c'><circle cx='4' cy='4' r='3'/></clipPath>\
      <g clip-path='url(#c)'><polyline points='0 0 9 9 nan' stroke='currentcolor'/></g><rect width='5' height='5' fill='#fff'/></svg>",
    b"\x08<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><mask id='m'><rect width='1' height='1' fill='url(#g)'/></mask>\
      <linearGradient id='g'><stop/><stop offset='1' stop-color='#fff'/></linearGradient><g id='!1+D5'><ellipse rx='5' ry='3' \
      mask='url(#m)' stroke='oklch(50% .1 20)'/></g></svg>",
    b"\x10<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><symbol id='s' viewBox='0 0 2 2'><line x2='3' y2='3' \
      stroke='#000' marker-end='url(#k)'/></symbol><marker id='k'><path d='M0 0L3 1'/></marker><use href='#s' width='4' height='4'/></svg>",
];

/// Each way of lifting a pen, behind the byte that chooses it, and between them every word that is read.
const GCODE: [&[u8]; 9] = [
    b"\x00%\nN10 G21 G90 G17\r\nM5\nG0 X1.5Y-2\nM3 S90\ng1x2 y3 f1200 (a remark) ; and another\nX4\nM5\nM2\n%\n",
    b"\x01G20\nG0 Z5\nG0 X1 Y1\nG1 Z-1 F100\nG2 X2 Y0 I0.5 J-0.5\nG3 X1 Y1 R1\nG3 X1 Y1 R-1\nG0 Z5\nM30\n",
    b"\x02M103 (disable RPM)\nM300 S50\nG4 P120\nG1 X10 Y10 F3500.00\nM300 S30.00 (pen down)\nG4 P120\nG1 X12\nM17\nM18\nM01 (wait?)\n",
    b"\x03G91\nM3 S1000\nG1 X1 F6000\nS500 X1\nG92 X0 Y0\nG90 G53 G0 X5\nM4 S0\nG28\n",
    b"\x04M4 S255\nG1X5F300\nM5\nG0X0Y0\n/G1 X99\n",
    b"\x05G1 X10 Y10 Z90 F1000\nG1 Z130\nG1 X20\nG1 Z90\n",
    b"\x06G00 X1\nG01 X2 Y2\nG1 X.5 Y-.5 E0.3\nG80\nM280 P0 S40\nM106 S255\n",
    b"\x07M280 P0 S90\nG0 X1\nM280 P0 S40\nG1 X2 F60\nM280 P0 S90\nG4 S0.5\nN5 G1 X3*71\nG1 X1e3\nG1 X1 X2\nM6 T3\n",
    b"\x08G1 X10 Y10 A50\nM1 90\nM2 U160 D90\nG38.2 X1\nG1 X99999999999\n$H\nG5.1 X1\nG2 X1 Y1 I1 R2\nG1 X",
];

/// The languages of cutters, with what is left out of them.
const CUTTERS: [&[u8]; 3] = [
    b"H\nJ1\nM400,400\nD800,400,800,800\nI-400,-400\nR10,10\nC500,500,100,0,360\nL1\nB20\nS5\nPtext\nX1,10,5\n^IN\n",
    b"\x1b\x04FX10,1\x03!10,1\x03M100,100\x03D200,100,200,300\x03E-10,10\x03Y0,0,50,0,50,50,100,0\x03W0,0,50,50,0,3600\x03FN0\x03J1\x03",
    b"\x1b\x00H,\x03O5,5\x03)3,10,10,20\x03]100,300,300,0,3600\x03B100\x03L5\x03TB50,381\x03&100,100,1,2\x03SO0\x03",
];

/// Tables, blocks and between them every kind of entity of a DXF.
const DXF: [&[u8]; 3] = [
    b"0\nSECTION\n2\nTABLES\n0\nLTYPE\n2\nD\n49\n2\n49\n-1\n0\nLAYER\n2\n7a\n62\n-3\n6\nD\n0\nENDSEC\n0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nB\n\
      10\n1\n20\n1\n0\nARC\n6\nD\n10\n0\n20\n0\n40\n9\n50\n0\n51\n90\n0\nENDBLK\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nB\n10\n5\n20\n5\n\
      41\n2\n50\n30\n70\n2\n44\n9\n0\nCIRCLE\n10\n0\n20\n0\n40\n1\n230\n-1\n0\nENDSEC\n0\nEOF\n",
    b"0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n70\n1\n10\n0\n20\n0\n42\n.5\n10\n9\n20\n9\n0\nSPLINE\n71\n2\n40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n\
      40\n1\n10\n0\n20\n0\n10\n5\n20\n9\n10\n9\n20\n0\n41\n1\n41\n2\n41\n1\n0\nMTEXT\n10\n0\n20\n0\n40\n3\n41\n9\n1\n{\\H2x;a\\P%%d\\S1^2;}\n0\nTEXT\n10\n0\n20\n\
      0\n11\n9\n21\n9\n40\n3\n72\n5\n1\nab\n0\nELLIPSE\n10\n0\n20\n0\n11\n5\n21\n1\n40\n.3\n41\n0\n42\n4\n0\nENDSEC\n0\nEOF\n",
    b"0\nSECTION\n2\nENTITIES\n0\nHATCH\n70\n0\n91\n2\n92\n2\n72\n0\n73\n1\n93\n3\n10\n0\n20\n0\n10\n9\n20\n0\n10\n9\n20\n9\n97\n0\n92\n1\n93\n1\n72\n3\n\
      10\n5\n20\n5\n11\n2\n21\n0\n40\n.5\n50\n0\n51\n360\n73\n0\n97\n0\n75\n0\n78\n1\n53\n45\n43\n0\n44\n0\n45\n0\n46\n1\n79\n2\n49\n1\n49\n-1\n0\nPOLYLINE\n70\n\
      16\n71\n2\n72\n2\n0\nVERTEX\n10\n0\n20\n0\n0\nVERTEX\n10\n1\n20\n0\n0\nVERTEX\n10\n0\n20\n1\n0\nVERTEX\n10\n1\n20\n1\n0\nSEQEND\n0\n3DFACE\n10\n0\n20\n0\n\
      11\n1\n21\n0\n12\n1\n22\n1\n0\nXLINE\n10\n0\n20\n0\n0\nENDSEC\n0\nEOF\n",
];

/// Between them, every command of HPGL and HP-GL/2 that is carried out.
const HPGL: [&[u8]; 14] = [
    b"IN;DF;SP1;VS2.5;PU400,400;PD800,400,800,800;PR;PD-10,20;PA;CI200;CI100,60;PU;SP0;PG;",
    b"\x1b.(;\x1b.I81;;17:IN;IP0,0,4000,3000;SC0,100,0,75,1;PU10,10;PD20,20;IR25,25;RO90;PS4000,3000;PD1,1;",
    b"IW0,0,1000,1000;PU-500,500;PD2000,500;CI700;IW;LT2,5;PD0,0,900,0;LT-4;AA0,0,90;LT0;PD5,5;UL1,3,1,0,2;LT1;PD99,0;",
    b"PU10,10;PM0;PD20,10,20,20;PM1;PU0,0;CI5;PM2;FT3,2,30;FP;FT4;FP1;EP;PW0.3;FT1;RA90,80;EA9,9;ER5,5;RR3,3;",
    b"EW100,0,90;WG50,30,60,10;AC5,5;UF1,2,3;FT6;RA20,20;FT10,25;RR9,9;PT0.3;WU1;PW0.1;PD;AR10,0,-90,20;CT1;CI100,5;",
    b"SI0.2,0.3;LBHello \xC3\xA9\r\n\x08\x03;SR1,2;DI1,1;DR0,1;SL0.3;DV1,1;LO15;ES0.1,0.2;LBcentred\x03CP2,-1;CP;",
    b"DT#,0;LBshown#DT;SM*;PA1,1,2,2;SM;UC4,7,99,0,1,-4,0,-99,2,2;XT;TL1,2;YT;SD1,277,4,12;SS;",
    b"PD;BZ0,400,400,400,400,0,400,-400,800,-400,800,0;BR1,1,2,2,10,0;AT0,100,-100,0;RT1,1,2,0,9;",
    b"PE7<=OkGest;PE<=o\xD5c\xC9S\xC2\xBF<yR\xC3\xBFT\xC2\xBF;PE>\xC5:\xC3\xBF\xBF;",
    b"PE<=o\xC3\x95c\xC3\x89S\xC3\x82\xC2\xBF;",
    b"\x1bE\x1b&l1X\x1b%0BBPIN;NP8;PC1,0,0,0;PUPDPA5 5-3\x1b%0Anot read\x1b%1BPD;CO\"a;b\";MG;OE;\x1bE",
    b"BLkept\x03PU5,5;PB;CS33;CA-1;DL65,0,0,32,32,-128,9,9;LB[{\x0eA\x0fA\x03SA;LBA\x03SS;AD1,39;SD1,277;LB\xC5\x03LM1;",
    b"RF2,2,2,1,0,0,0;FT11,2;RA90,90;FT21,3;RR9,9;CV1,2;RP3;DL65;DL;",
    b"@PJL\x1b%-12345X@PJL ENTER LANGUAGE=HPGL2\r\nIN;PD1,2,,3;ZZ;PD--1;PU:;SP300;LBopen",
];
