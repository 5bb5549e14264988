#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Trains the network of people's shapes on patches of export_patches, and writes it as ONNX.

    people_by_shape.py TRAIN.patches HELD_OUT.patches OUT.onnx

One thread and fixed seeds: the same patches give the same network. Requires python3-torch and python3-numpy.
"""
import sys

import numpy as np
import torch
from torch import nn

CHANNELS, ROWS, COLUMNS = 5, 28, 16  # as in shape_patch.h
RECORD = np.dtype([("person", "<f4"), ("offset", "<f4", 2), ("patch", "u1", (CHANNELS, ROWS, COLUMNS))])
EPOCHS, BATCH, RATE = 12, 128, 2e-3
DEPTH, SEEN = 0, 1  # channels


class PeopleNet(nn.Sequential):
    """Log-odds of a person, and the offset of its middle to the right and away from the camera [m]."""

    def __init__(self) -> None:
        super().__init__(
            nn.Conv2d(CHANNELS, 16, 3, padding=1), nn.ReLU(), nn.MaxPool2d(2),
            nn.Conv2d(16, 24, 3, padding=1), nn.ReLU(), nn.MaxPool2d(2),
            nn.Conv2d(24, 32, 3, padding=1), nn.ReLU(),
            nn.Conv2d(32, 48, (ROWS // 4, COLUMNS // 4)), nn.ReLU(),
            nn.Conv2d(48, 3, 1))


def varied(patches: torch.Tensor, offsets: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Mirrors half of the patches, hides a rectangle in a third and cells of half, and makes depths noisy."""
    count = len(patches)
    mirror = torch.rand(count) < 0.5
    patches[mirror] = patches[mirror].flip(3)
    offsets = offsets.clone()
    offsets[mirror, 0] *= -1
    for i in torch.nonzero(torch.rand(count) < 0.33).flatten().tolist():
        row, column = int(torch.randint(ROWS, (1,))), int(torch.randint(COLUMNS, (1,)))
        patches[i, :, row:row + 8, column:column + 6] = 0
        patches[i, DEPTH, row:row + 8, column:column + 6] = 0.5
    hidden = torch.rand(count, ROWS, COLUMNS) < (0.8 * torch.rand(count, 1, 1) - 0.4)
    patches *= ~hidden[:, None]
    patches[:, DEPTH][hidden] = 0.5
    noise = 0.1 * torch.randn(count, ROWS, COLUMNS) * torch.rand(count, 1, 1)
    seen = patches[:, SEEN] > 0
    patches[:, DEPTH] = torch.where(seen, (patches[:, DEPTH] + noise).clamp(0, 1), patches[:, DEPTH])
    return patches, offsets


def tensors(records: np.ndarray) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Patches, labels and offsets."""
    return (torch.from_numpy(records["patch"].astype(np.float32) / 255), torch.from_numpy(records["person"].copy()),
            torch.from_numpy(records["offset"].copy()))


def evaluate(net: nn.Module, records: np.ndarray) -> None:
    """Prints recall and precision by the minimum score."""
    said = []
    with torch.no_grad():
        for start in range(0, len(records), BATCH):
            said.append(net(tensors(records[start:start + BATCH])[0])[:, :, 0, 0])
    said = torch.cat(said)
    person = torch.from_numpy(records["person"].copy()) > 0.5
    score = torch.sigmoid(said[:, 0])
    for limit in (0.5, 0.7, 0.8, 0.9, 0.95):
        called = score > limit
        right = int((called & person).sum())
        print(f"score > {limit}: recall {right / max(1, int(person.sum())):.3f}, "
              f"precision {right / max(1, int(called.sum())):.3f}, "
              f"false of others {int((called & ~person).sum()) / max(1, int((~person).sum())):.5f}")
    off = (said[person, 1:] - torch.from_numpy(records["offset"].copy())[person]).abs().median(0)[0]
    print(f"median error of the middle: {off[0]:.3f} m across, {off[1]:.3f} m away")


def train(records: np.ndarray) -> nn.Module:
    """The network after EPOCHS."""
    net = PeopleNet()
    steps = EPOCHS * (len(records) // BATCH)
    optimizer = torch.optim.Adam(net.parameters(), lr=RATE, weight_decay=1e-5)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, RATE, total_steps=steps + 1)
    for epoch in range(EPOCHS):
        order = np.random.permutation(len(records))
        total = 0.0
        for start in range(0, len(records) - BATCH + 1, BATCH):
            patches, person, offsets = tensors(records[np.sort(order[start:start + BATCH])])
            patches, offsets = varied(patches, offsets)
            said = net(patches)[:, :, 0, 0]
            loss = nn.functional.binary_cross_entropy_with_logits(said[:, 0], person)
            off = nn.functional.smooth_l1_loss(said[:, 1:], offsets, reduction="none", beta=0.05).sum(1)
            loss = loss + (off * person).sum() / person.sum().clamp(min=1)
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            schedule.step()
            total += float(loss)
        print(f"epoch {epoch + 1}: loss {total * BATCH / len(records):.4f}", flush=True)
    return net


def main() -> int:
    """Trains, evaluates and writes."""
    train_file, held_out_file, out = sys.argv[1:]
    torch.manual_seed(1)
    np.random.seed(1)
    torch.set_num_threads(1)
    torch.use_deterministic_algorithms(True)
    records = np.memmap(train_file, RECORD, "r")
    held_out = np.memmap(held_out_file, RECORD, "r")
    print(f"{len(records)} patches, {int(records['person'].sum())} of people; held out {len(held_out)}")
    net = train(records).eval()
    evaluate(net, held_out)
    torch.onnx.export(net, torch.zeros(1, CHANNELS, ROWS, COLUMNS), out, opset_version=11)
    return 0


if __name__ == "__main__":
    sys.exit(main())
