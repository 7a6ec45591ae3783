"""Draws four_inks.jpg beside it: 16 x 8 px of four inks (a CMYK JPEG with Adobe's mark), black on the left half, paper
on the right. Needs Pillow: `image` writes no JPEG of four inks. Run it in this folder."""

from PIL import Image

picture = Image.new("CMYK", (16, 8), (0, 0, 0, 0))
picture.paste((0, 0, 0, 255), (0, 0, 8, 8))
picture.save("four_inks.jpg", quality=90)
