//! The simulated EBB: raw bytes in, exact bytes out, and steps at the ticks that the documented arithmetic
//! gives.

use plotter_motion::{Machine, MachineConfig, Pen};
use plotter_replay::live::{Line, MachineLine, SimulatedMachine, Spoken};
use plotter_replay::log::SwitchName;
use plotter_replay::player::EbbBoard;
use plotter_replay::{AnyController, Controller};
use std::time::Duration;

const TICK: Duration = Duration::from_micros(40);

/// A board, and what it has done.
struct Desk {
    board: EbbBoard,
    now: Duration,
    said: Vec<u8>,
    /// Ticks at which each motor stepped, and which way.
    steps: Vec<(u128, i8, i8)>,
}

impl Desk {
    fn new() -> Self {
        Self { board: EbbBoard::switched_on(), now: Duration::ZERO, said: Vec::new(), steps: Vec::new() }
    }

    fn fetch(&mut self) {
        while let Some(step) = self.board.step(self.now) {
            self.steps.push((self.now.as_nanos() / TICK.as_nanos(), step.x, step.y));
        }
        self.said.extend(std::iter::from_fn(|| self.board.transmit()));
    }

    /// What is answered at once.
    fn ask(&mut self, line: &str) -> String {
        self.said.clear();
        for &byte in line.as_bytes() {
            self.board.receive(self.now, byte);
            self.fetch();
        }
        String::from_utf8(core::mem::take(&mut self.said)).unwrap()
    }

    /// What is said until then.
    fn run_to(&mut self, to: Duration) -> String {
        while let Some(due) = self.board.next_tick().filter(|&due| due <= to) {
            self.now = due;
            self.board.tick(due);
            self.fetch();
        }
        self.now = to;
        String::from_utf8(core::mem::take(&mut self.said)).unwrap()
    }

    /// Until nothing is to be done.
    fn run(&mut self) -> String {
        let mut said = String::new();
        while self.board.is_busy() {
            said += &self.run_to(self.now + TICK);
        }
        said
    }

    /// Steps of each motor, with their signs.
    fn made(&self) -> [i32; 2] {
        self.steps.iter().fold([0; 2], |[x, y], step| [x + i32::from(step.1), y + i32::from(step.2)])
    }

    fn last_tick(&self) -> u128 {
        self.steps.last().unwrap().0
    }
}

#[test]
fn queries_are_answered_as_documented() {
    let mut desk = Desk::new();
    for (line, answer) in [
        ("V\r", "EBBv13_and_above EB Firmware Version 2.8.1\r\n"),
        ("v\n", "EBBv13_and_above EB Firmware Version 2.8.1\r\n"),
        ("QM\r", "QM,0,0,0,0\n\r"),
        ("QS\r", "0,0\n\rOK\r\n"),
        ("QP\r", "1\n\rOK\r\n"),
        ("QE\r", "0,0\n\rOK\r\n"),
        ("QB\r", "0\r\nOK\r\n"),
        ("QG\r", "10\r\n"),
        ("QC\r", "0394,0300\r\nOK\r\n"),
        ("QR\r", "0\r\nOK\r\n"),
        ("SN,41\r", "OK\r\n"),
        ("NI\r", "OK\r\n"),
        ("QN\r", "0000000042\r\nOK\r\n"),
        ("ND\r", "OK\r\n"),
        ("QN\r", "0000000041\r\nOK\r\n"),
        ("SL,7\r", "OK\r\n"),
        ("QL\r", "007\r\nOK\r\n"),
        ("QT\r", "\r\nOK\r\n"),
        ("ST,East EBB\r", "OK\r\n"),
        ("QT\r", "East EBB\r\nOK\r\n"),
        ("PO,B,3,1\r", "OK\r\n"),
        ("PD,B,3,0\r", "OK\r\n"),
        ("PI,B,3\r", "PI,1\r\n"),
        ("ES\r", "0,0,0,0,0\n\rOK\r\n"),
        ("CS\r", "OK\r\n"),
        ("R\r", "OK\r\n"),
        ("QN\r", "0000000000\r\nOK\r\n"),
        ("QT\r", "East EBB\r\nOK\r\n"),
    ] {
        assert_eq!(desk.ask(line), answer, "{line:?}");
    }
}

#[test]
fn lines_that_are_wrong_are_refused_with_the_boards_words() {
    let mut desk = Desk::new();
    for (line, answer) in [
        ("ZZ\r", "!8 Err: Unknown command 'ZZ:5A5A'\r\n"),
        ("Z,1\r", "!8 Err: Unknown command 'Z:5A'\r\n!7"),
        ("SM\r", "!4 Err: Missing parameter(s)\r\n"),
        ("SM,100\r", "!4 Err: Missing parameter(s)\r\n"),
        ("SM;1\r", "!5 Err: Need comma next, found: ';'\r\n"),
        ("SM,0,1,1\r", "!6 Err: Invalid parameter value\r\n"),
        ("SM,-1,1\r", "!6 Err: Invalid parameter value\r\n"),
        ("SM,10,251,0\r", "OK\r\n"), // whole steps in a ms: 25
        ("SM,10,260,0\r", "!0 Err: <axis1> step rate > 25K steps/second.\n\r"),
        ("SM,1311,1,1\r", "!0 Err: <axis1> step rate < 1.31Hz.\n\r"),
        ("SM,16777216,0,0\r", "!0 Err: <move_duration> larger than 16777215 ms.\n\r"),
        ("XM,10,200,200\r", "!0 Err: <axis1> step rate > 25K steps/second.\n\r"),
        ("XM,10,200,-200\r", "!0 Err: <axis2> step rate > 25K steps/second.\n\r"),
        ("LM,0,1,0,1,0,0\r", "!6 Err: Invalid parameter value\r\n"),
        ("LT,0,1,0,1,0\r", "!6 Err: Invalid parameter value\r\n"),
        ("CU,1,2\r", "OK\r\n!6 Err: Invalid parameter value\r\n"),
        ("HM,0\r", "!6 Err: Invalid parameter value\r\n"),
        ("CS,1\r", "OK\r\n!7 Err: Extra parameter\r\n"),
    ] {
        let said = desk.ask(line);
        assert!(said.starts_with(answer.trim_end_matches("!7")), "{line:?}: {said:?}");
        desk.run();
    }
    let long = format!("{}\r", "9".repeat(256));
    assert!(desk.ask(&long).starts_with("!3 Err: RX Buffer overrun\r\n"));
    assert_eq!(desk.ask("QM\r"), "QM,0,0,0,0\n\r");
}

/// Of SM,1000,3125: 2³¹ · 3125 / 25000 is 2²⁸, a step each 8 ticks.
#[test]
fn steps_at_a_constant_speed_come_at_even_ticks() {
    let mut desk = Desk::new();
    assert_eq!(desk.ask("SM,1000,3125,-625\r"), "OK\r\n");
    desk.run();
    assert_eq!(desk.made(), [3_125, -625]);
    // The command is taken from the queue in tick 1, and begins in tick 2.
    let first: Vec<u128> = desk.steps.iter().filter(|step| step.1 != 0).map(|step| step.0 - 1).collect();
    assert!(first.iter().zip(1..).all(|(&tick, n)| tick == 8 * n), "{:?}", &first[..9]);
    // 625 steps of 2³¹ · 625 / 25000 = 53687091.2, of which the fifth is left out: 40 ticks and, late, one
    // more
    let second: Vec<u128> = desk.steps.iter().filter(|step| step.2 != 0).map(|step| step.0 - 1).collect();
    assert_eq!((second[0], second[624]), (41, 25_001));
    assert_eq!(desk.ask("QS\r"), "3125,-625\n\rOK\r\n");
}

/// The documentation's example: 45 steps/s to 250 steps/s within 60 steps, in 0.4068 s.
#[test]
fn steps_that_grow_faster_come_as_the_documented_sums_say() {
    let mut desk = Desk::new();
    assert_eq!(desk.ask("LM,3865471,60,1732,0,0,0\r"), "OK\r\n");
    desk.run();
    assert_eq!(desk.made(), [60, 0]);
    // After t ticks the sum is 3865471 t + 866 t²: the first step at 2³¹, the last at 60 · 2³¹.
    for (index, steps) in [(0, 1.0_f64), (29, 30.0), (59, 60.0)] {
        let (rate, half) = (3_865_471.0_f64, 866.0);
        let t = ((rate * rate + 4.0 * half * steps * 2_f64.powi(31)).sqrt() - rate) / (2.0 * half);
        let tick = desk.steps[index].0 - 1;
        assert!((tick as f64 - t).abs() <= 1.0, "step {steps}: tick {tick}, by the formula {t}");
    }
    assert_eq!(desk.last_tick() - 1, 10_169); // as documented
}

#[test]
fn accumulators_keep_what_is_over_unless_they_are_cleared() {
    // 3/4 of a step a tick: after a step half of one is over, so that the next move's first step comes at
    // once.
    let rate = 3 * (1_u32 << 29);
    for (clear, ticks) in [(0, 1), (1, 2), (3, 2)] {
        let mut desk = Desk::new();
        desk.ask(&format!("LM,{rate},1,0,0,0,0,3\rLM,{rate},1,0,0,0,0,{clear}\r"));
        desk.run();
        let [first, second] = desk.steps[..] else { panic!("{:?}", desk.steps) };
        assert_eq!((first.0, second.0 - first.0), (3, ticks), "clear {clear}");
    }
}

#[test]
fn a_move_for_a_time_makes_what_steps_it_makes() {
    let mut desk = Desk::new();
    // 1/100 of a step a tick for 1000 ticks, one way and the other
    assert_eq!(desk.ask("LT,1001,21474836,0,-21474836,0,3\r"), "OK\r\n");
    desk.run();
    assert_eq!(desk.made(), [10, -10]);
    assert_eq!(desk.now.as_nanos() / TICK.as_nanos(), 1_002);
}

#[test]
fn one_command_waits_and_what_comes_behind_it_waits_with_the_line() {
    let mut desk = Desk::new();
    assert_eq!(desk.ask("SM,100,0,0\r"), "OK\r\n");
    desk.run_to(TICK);
    assert_eq!(desk.ask("SM,100,100,0\r"), "OK\r\n");
    assert_eq!(desk.ask("QM\r"), "QM,1,0,0,1\n\r");
    // The third one finds no room, and the query behind it is not looked at.
    assert_eq!(desk.ask("SM,100,0,50\rQM\r"), "");
    assert_eq!(desk.ask("ES\r"), "");
    assert_eq!(desk.run_to(99 * Duration::from_millis(1)), "");
    // The first is over after 2500 ticks: the second runs, the third waits, and both are stopped by the ES.
    let said = desk.run_to(Duration::from_millis(101));
    assert_eq!(said, "OK\r\nQM,1,1,0,1\n\r1,0,50,100,0\n\rOK\r\n");
    desk.run();
    assert_eq!(desk.made(), [0, 0]);
}

#[test]
fn an_emergency_stop_says_what_it_interrupts_and_the_count_is_true() {
    let mut desk = Desk::new();
    desk.ask("EM,1,1\r");
    desk.run();
    desk.ask("SM,1000,1000,500\r");
    desk.run_to(desk.now + TICK);
    desk.ask("XM,500,300,-100\r");
    desk.run_to(desk.now + Duration::from_millis(500));
    assert_eq!(desk.ask("QM\r"), "QM,1,1,1,1\n\r");
    // 12,500 ticks of one step in 25 and of one in 50, less than a tick late; XM: 300 - 100 and 300 + 100
    assert_eq!(desk.ask("ES\r"), "1,200,400,501,251\n\rOK\r\n");
    assert_eq!(desk.ask("QM\r"), "QM,0,0,0,0\n\r");
    assert_eq!(desk.ask("QS\r"), "499,249\n\rOK\r\n");
    assert_eq!(desk.ask("QE\r"), "16,16\n\rOK\r\n");
    assert_eq!(desk.ask("ES,1\r"), "0,0,0,0,0\n\rOK\r\n");
    assert_eq!(desk.ask("QE\r"), "0,0\n\rOK\r\n");
    desk.run_to(desk.now + Duration::from_secs(2));
    assert_eq!(desk.made(), [499, 249]);
    // Home from there: 499 steps at 1000 steps/s, 499 ms
    let began = desk.now;
    assert_eq!(desk.ask("HM,1000\r"), "OK\r\n");
    desk.run();
    assert_eq!(desk.ask("QS\r"), "0,0\n\rOK\r\n");
    assert_eq!((desk.now - began).as_millis(), 499);
}

#[test]
fn going_home_with_few_steps_of_one_motor_takes_two_moves() {
    let mut desk = Desk::new();
    desk.ask("SM,700,5000,1\r");
    desk.run();
    // At 1000 steps/s 5 s for one step: less than 1.31 steps/s
    desk.ask("HM,1000\r");
    desk.run();
    assert_eq!(desk.ask("QS\r"), "0,0\n\rOK\r\n");
    desk.ask("HM,1000,-30,40\r");
    desk.run();
    assert_eq!(desk.ask("QS\r"), "-30,40\n\rOK\r\n");
}

#[test]
fn the_pen_goes_by_its_rate_and_the_next_command_waits_as_long_as_asked() {
    let mut desk = Desk::new();
    assert_eq!(desk.ask("SC,4,16000\rSC,5,12000\rSC,11,0\rSC,12,500\r"), "OK\r\n".repeat(4));
    let began = desk.now;
    assert_eq!(desk.ask("SP,1,10\rSP,0,300\r"), "OK\r\n");
    // It is asked for when it begins.
    assert_eq!(desk.ask("QP\r"), "");
    desk.run_to(Duration::from_millis(20));
    assert_eq!(desk.ask("QP\r"), "0\n\rOK\r\n");
    assert_eq!(desk.ask("QM\r"), "QM,1,0,0,0\n\r");
    desk.run();
    // 250 ticks and 7500 ticks, and one until it begins
    assert_eq!(desk.now - began, 7_751 * TICK);
    assert_eq!(desk.board.pen(), Some(Pen::Down));
    // 4000 by 500 every 24 ms: half of the way down after 5 pulses, 96 ms after the first
    let mut desk = Desk::new();
    desk.ask("SC,4,16000\rSC,5,12000\rSC,11,0\rSC,12,500\rSP,1\r");
    desk.run_to(Duration::from_millis(47));
    desk.ask("SP,0\r");
    for (ms, pen) in [(48, Pen::Up), (48 + 4 * 24 - 1, Pen::Up), (48 + 4 * 24, Pen::Down)] {
        desk.run_to(Duration::from_millis(ms));
        assert_eq!(desk.board.pen(), Some(pen), "{ms} ms");
    }
    // TP turns it round, S2 moves the same servo
    desk.ask("TP,50\r");
    desk.run();
    assert_eq!(desk.ask("QP\r"), "1\n\rOK\r\n");
    desk.ask("S2,12000,4,0,50\r");
    desk.run();
    assert_eq!((desk.ask("QP\r"), desk.board.pen()), (String::from("0\n\rOK\r\n"), Some(Pen::Down)));
}

#[test]
fn a_coarser_step_mode_makes_longer_steps_and_counts_from_zero() {
    let mut desk = Desk::new();
    desk.ask("SM,100,100,0\r");
    desk.run();
    desk.ask("EM,3,1\r");
    desk.run();
    assert_eq!(desk.ask("QE\r"), "4,4\n\rOK\r\n");
    assert_eq!(desk.ask("QS\r"), "0,0\n\rOK\r\n");
    desk.steps.clear();
    desk.ask("SM,100,10,-5\r");
    desk.run();
    assert_eq!(desk.ask("QS\r"), "10,-5\n\rOK\r\n");
    assert_eq!(desk.made(), [40, -20]); // in sixteenths
    assert_eq!(desk.ask("EM,0,1\r"), "OK\r\n");
    desk.run();
    assert_eq!(desk.ask("QE\r"), "0,4\n\rOK\r\n");
}

#[test]
fn answers_can_be_switched_off_and_the_button_is_told_once() {
    let mut desk = Desk::new();
    assert_eq!(desk.ask("CU,1,0\r"), "");
    assert_eq!(desk.ask("NI\rQN\r"), "0000000001\r\n");
    assert_eq!(desk.ask("CU,1,1\r"), "OK\r\n");
    desk.board.switch(desk.now, &SwitchName::new("prg").unwrap(), true);
    assert_eq!(desk.ask("QG\r"), "30\r\n");
    assert_eq!(desk.ask("QB\r"), "0\r\nOK\r\n");
    // CU,2,0: durations and rates are not looked at
    assert_eq!(desk.ask("CU,2,0\rSM,1,30,0\r"), "OK\r\nOK\r\n");
    desk.run();
    assert_eq!(desk.ask("QS\r"), "30,0\n\rOK\r\n");
    assert_eq!(desk.ask("BL\r"), "OK\r\n");
    assert_eq!(desk.ask("V\r"), "");
}

#[test]
fn without_its_supply_the_board_counts_and_the_motors_stand() {
    let mut desk = Desk::new();
    desk.board.emergency_stop(desk.now, true);
    desk.ask("SM,100,100,100\r");
    desk.run();
    assert_eq!(desk.ask("QC\r"), "0394,0000\r\nOK\r\n");
    assert_eq!((desk.ask("QS\r"), desk.made()), (String::from("100,100\n\rOK\r\n"), [0, 0]));
}

#[test]
fn any_bytes_are_taken_and_the_board_answers_after_them() {
    let mut random = plotter_motion::SplitMix64::new(5);
    let mut desk = Desk::new();
    let words = b"SMXLTQPE,,,--0123456789\r\r\n\x08\x1b ";
    for _ in 0..20_000 {
        let byte = if random.below(8) == 0 {
            u8::try_from(random.below(256)).unwrap()
        } else {
            words[random.below(words.len())]
        };
        desk.board.receive(desk.now, byte);
        desk.run_to(desk.now + Duration::from_micros(200));
    }
    desk.board.switch(desk.now, &SwitchName::new("restart").unwrap(), true);
    let said = desk.ask("\rQM\r");
    assert!(said.ends_with("QM,0,0,0,0\n\r"), "{}", &said[said.len() - 40..]);
}

fn machine() -> Machine {
    let mut config = MachineConfig::stepper_plotter();
    config.steppers_mut().unwrap().x.steps_per_mm = 80.0;
    config.steppers_mut().unwrap().y.steps_per_mm = 80.0;
    Machine::new(config).unwrap()
}

fn until(line: &MachineLine, count: usize) -> String {
    let mut said = Vec::new();
    let mut bytes = [0; 64];
    while said.windows(2).filter(|two| two == b"OK").count() < count {
        let taken = line.receive(&mut bytes, Duration::from_secs(5)).unwrap();
        assert!(taken > 0, "{}", String::from_utf8_lossy(&said));
        said.extend(&bytes[..taken]);
    }
    String::from_utf8(said).unwrap()
}

#[test]
fn an_axidraw_moves_both_axes_with_both_motors() {
    for (is_mixed, at) in [(true, (10.0, 20.0)), (false, (30.0, 10.0))] {
        let line = SimulatedMachine::speaking(&machine(), Spoken::Ebb { is_mixed }).unwrap().line(1e6);
        // A is our y, and B our x
        line.send(b"EM,1,1\rXM,2000,1600,800\rSM,10,0,0\rSM,10,0,0\r").unwrap();
        until(&line, 4);
        let seen = line.seen();
        // A rotor rests where friction lets it, within two of its steps of 1/80 mm.
        assert!((seen.at.x - at.0).abs() < 0.025 && (seen.at.y - at.1).abs() < 0.025, "{:?}", seen.at);
        assert_eq!(seen.lost_steps, [0, 0]);
    }
}

#[test]
fn other_machines_are_refused_and_a_log_says_which_controller() {
    let gantry = Machine::new(MachineConfig::default()).unwrap();
    assert!(SimulatedMachine::speaking(&gantry, Spoken::Ebb { is_mixed: true }).is_err());
    let header = plotter_replay::log::Header::new().with_text("protocol", "ebb");
    let mut controller = AnyController::for_header(&header, None).unwrap();
    controller.receive(Duration::ZERO, b'V');
    controller.receive(Duration::ZERO, b'\r');
    assert_eq!(controller.transmit(), Some(b'E'));
}
