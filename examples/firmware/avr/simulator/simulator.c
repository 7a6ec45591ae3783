/* An ATmega328P with two small motors on it, a millisecond at a time.
 *
 *   simulator FIRMWARE.elf
 *
 * Asked on standard input, byte by byte: 0 = run a millisecond; 1 b = the line brings the byte b, run a millisecond.
 * Answered on standard output:
 *   n, n bytes that the firmware has sent; m, m changes of port C, each its clock cycle (4 bytes) and the port (1);
 *   where the shafts stand, x and y, in quarters of an encoder's period, and the most bytes of stack so far (4 bytes each).
 *   Least byte first.
 *
 * The motors: a speed that follows the duty, less friction, with a time constant. The shafts turn encoders on pins of port B.
 */
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <unistd.h>

#define CLOCK_HZ 16000000.0
#define CYCLES_PER_MS 16000
#define CYCLES_PER_STEP 160           /* of the motors: 10 us */
#define QUARTERS_PER_S 2000.0         /* at full duty without friction */
#define FRICTION 0.0154               /* as a share of full duty: 1.3 mN m of 84.6 mN m, as the documented gantry has it */
#define TIME_CONSTANT_S 0.002
/* data space addresses of OCR0A, OCR0B, PORTD, TCCR0A (data sheet, "Register Summary") */
#define OCR0A 0x47
#define OCR0B 0x48
#define PORTD 0x2B
#define TCCR0A 0x44
#define RAM_END 0x8ff                 /* where the stack begins */

static FILE *answers; /* simavr itself writes to standard output */
static uint8_t sent[255], ports[255][5];
static unsigned sent_count, port_count;
static avr_t *avr;

static void on_sent(avr_irq_t *irq, uint32_t value, void *param) {
	(void)irq; (void)param;
	if (sent_count < sizeof sent) sent[sent_count++] = value;
}

static void on_port(avr_irq_t *irq, uint32_t value, void *param) {
	(void)irq; (void)param;
	if (port_count < 255) {
		uint32_t cycle = avr->cycle;
		for (int i = 0; i < 4; i++) ports[port_count][i] = cycle >> (8 * i);
		ports[port_count++][4] = value;
	}
}

struct shaft { double speed, place; avr_irq_t *a, *b; };

static void show(struct shaft *shaft) {
	/* quarters 0 to 3 of a period, forwards: A and B, A, none, B */
	static const uint8_t A[4] = { 1, 1, 0, 0 }, B[4] = { 1, 0, 0, 1 };
	int quarter = (int)((int64_t)floor(shaft->place) & 3);
	avr_raise_irq(shaft->a, A[quarter]);
	avr_raise_irq(shaft->b, B[quarter]);
}

static void turn(struct shaft *shaft, double duty) {
	double dt = CYCLES_PER_STEP / CLOCK_HZ;
	double left = fmax(fabs(duty) - FRICTION, 0);
	shaft->speed += (copysign(left, duty) * QUARTERS_PER_S - shaft->speed) * dt / TIME_CONSTANT_S;
	shaft->place += shaft->speed * dt;
	show(shaft);
}

static void put_number(int32_t number) {
	for (int i = 0; i < 4; i++) putc((uint32_t)number >> (8 * i) & 0xff, answers);
}

int main(int argc, char **argv) {
	static elf_firmware_t firmware;
	answers = fdopen(dup(STDOUT_FILENO), "wb");
	if (!answers || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) return 2;
	if (argc != 2 || elf_read_firmware(argv[1], &firmware) != 0) {
		fprintf(stderr, "simulator: cannot read the firmware; usage: simulator FIRMWARE.elf\n");
		return 2;
	}
	avr = avr_make_mcu_by_name("atmega328p");
	if (!avr || avr_init(avr) != 0) {
		fprintf(stderr, "simulator: simavr does not know the ATmega328P\n");
		return 2;
	}
	avr->log = LOG_ERROR;
	avr->frequency = (uint32_t)CLOCK_HZ;
	avr_load_firmware(avr, &firmware);
	avr->frequency = (uint32_t)CLOCK_HZ;
	uint32_t flags = 0; /* neither to the console nor sleeping */
	avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
	avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), on_sent, NULL);
	avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('C'), IOPORT_IRQ_REG_PORT), on_port, NULL);
	avr_irq_t *line = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
	struct shaft shafts[2];
	for (int i = 0; i < 2; i++) {
		shafts[i].speed = 0;
		shafts[i].place = 0.5; /* in the middle of a quarter */
		shafts[i].a = avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('B'), 2 * i);
		shafts[i].b = avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('B'), 2 * i + 1);
		show(&shafts[i]);
	}
	avr_cycle_count_t motors_due = 0, end = 0;
	unsigned stack = 0;
	for (int asked; (asked = getchar()) != EOF;) {
		if (asked == 1) avr_raise_irq(line, (uint8_t)getchar());
		sent_count = port_count = 0;
		end += CYCLES_PER_MS;
		while (avr->cycle < end) {
			int state = avr_run(avr);
			if (state == cpu_Done || state == cpu_Crashed) {
				fprintf(stderr, "simulator: the firmware has crashed\n");
				return 1;
			}
			unsigned top = avr->data[R_SPL] | avr->data[R_SPH] << 8;
			if (top && RAM_END - top > stack) stack = RAM_END - top;
			while (motors_due <= avr->cycle) {
				motors_due += CYCLES_PER_STEP;
				int on = (avr->data[TCCR0A] & 0xa0) == 0xa0; /* both outputs are the timer's */
				double x = on ? avr->data[OCR0A] / 255.0 : 0, y = on ? avr->data[OCR0B] / 255.0 : 0;
				turn(&shafts[0], avr->data[PORTD] & 1 << 4 ? -x : x);
				turn(&shafts[1], avr->data[PORTD] & 1 << 7 ? -y : y);
			}
		}
		putc(sent_count, answers);
		fwrite(sent, 1, sent_count, answers);
		putc(port_count, answers);
		fwrite(ports, 5, port_count, answers);
		for (int i = 0; i < 2; i++) put_number((int32_t)floor(shafts[i].place));
		put_number((int32_t)stack);
		fflush(answers);
	}
	return 0;
}
