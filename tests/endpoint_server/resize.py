"""Prints what the models' own processor makes of the sizes in the tests of l4d-endpoint's `coordinates`."""

from transformers.models.qwen2_vl.image_processing_qwen2_vl import smart_resize

CASES = [
    (28, 3_136, 12_845_056, [(714, 490), (640, 480), (630, 518), (10, 10), (8000, 6000)]),
    (32, 65_536, 16_777_216, [(714, 490), (200, 120), (16_384, 2_048)]),
]

for factor, fewest, most, sizes in CASES:
    for width, height in sizes:
        rows, columns = smart_resize(height, width, factor=factor, min_pixels=fewest, max_pixels=most)
        print(factor, (width, height), "->", (columns, rows))
