import { expect, test } from "vitest";
import { describeReception } from "./health";

const QUIET = {
  is_connected: null,
  connection_error: "",
  interruptions: 0,
  interrupted_s: 0,
  rejected: 0,
  rejection: "",
  lost_messages: 0,
};

test("a receiver without defects has nothing to report", () => {
  expect(describeReception(QUIET)).toEqual([]);
  expect(describeReception({ ...QUIET, is_connected: true })).toEqual(["Connected."]);
});

test("a lost connection and rejected messages are named", () => {
  const lost = { ...QUIET, is_connected: false, connection_error: "no broker responds" };
  expect(
    describeReception({
      ...lost,
      interruptions: 2,
      interrupted_s: 5.25,
      rejected: 1,
      rejection: "10 bytes",
      lost_messages: 3,
    }),
  ).toEqual([
    "NOT CONNECTED: no broker responds",
    expect.stringMatching(/^Connection lost 2 times, for 5.\d s in all/),
    "1 message rejected; the newest: 10 bytes",
    "3 messages lost.",
  ]);
});
