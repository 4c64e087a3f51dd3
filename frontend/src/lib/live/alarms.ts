/** Alarms of a stream and who acknowledged them. */

interface Alarm {
  kind: string;
  subject: string;
  time_s: number;
}

/** Name of an alarm; there is one of a kind and subject at a time. */
export const alarmKey = ({ kind, subject, time_s }: Alarm): string =>
  `${kind} ${subject} ${time_s}`;

/** All alarms, each once; the same list where there is no new one. */
export function addAlarms<A extends Alarm>(known: readonly A[], more: readonly A[]): readonly A[] {
  const keys = new Set(known.map(alarmKey));
  const added = more.filter((alarm) => !keys.has(alarmKey(alarm)));
  return added.length > 0 ? [...known, ...added] : known;
}

/** Splits alarms into those that nobody has acknowledged, and the others with the names. */
export function splitAlarms<A extends Alarm>(
  alarms: readonly A[],
  acknowledgements: readonly (Alarm & { author: string })[],
): { open: A[]; acknowledged: (A & { author: string })[] } {
  const authors = new Map(acknowledgements.map((one) => [alarmKey(one), one.author]));
  const open: A[] = [];
  const acknowledged: (A & { author: string })[] = [];
  for (const alarm of alarms) {
    const author = authors.get(alarmKey(alarm));
    if (author === undefined) open.push(alarm);
    else acknowledged.push({ ...alarm, author });
  }
  return { open, acknowledged };
}
