import { Button, Group, Text } from "@mantine/core";

interface Props<Value> {
  merged: Value;
  mine: Value;
  theirs: Value;
  /** What both changed. */
  clashes: readonly string[];
  onResolve: (value: Value) => void;
}

/** The resolutions of two edits of the same version. */
export function ConflictResolutions<Value>(props: Props<Value>) {
  const { merged, mine, theirs, clashes, onResolve } = props;
  const choices = [
    { name: "merge", label: "Merge both", value: merged },
    { name: "mine", label: "Mine only", value: mine },
    { name: "theirs", label: "Theirs only", value: theirs },
  ];
  return (
    <>
      {clashes.length > 0 && (
        <Text size="sm" mt="sm" c="var(--page-warn)">
          Both changed {clashes.join(", ")}; in a merge, yours is used.
        </Text>
      )}
      <Group mt="sm" gap="sm">
        {choices.map(({ name, label, value }) => (
          <Button
            key={name}
            variant={name === "merge" ? "filled" : "default"}
            data-testid={`conflict-${name}`}
            onClick={() => {
              onResolve(value);
            }}
          >
            {label}
          </Button>
        ))}
      </Group>
    </>
  );
}
