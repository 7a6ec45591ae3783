//! What the two firmwares for the ATmega328P share: the board.
#![no_std]

pub mod board;
