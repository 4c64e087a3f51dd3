import { Stack, Text } from "@mantine/core";

/** What was noted of a source when it was imported: one line each. */
export function TableNotes({ notes }: { notes: readonly string[] }) {
  return (
    <Stack gap={2}>
      {notes.map((note) => (
        <Text size="xs" c="dimmed" key={note}>
          {note}
        </Text>
      ))}
    </Stack>
  );
}
