import { Button, Group, Text } from "@mantine/core";
import { count } from "../lib/format";

interface Props {
  noun: "maneuver" | "run";
  shown: number;
  /** How many there are in all; undefined until that is known. */
  total: number | undefined;
  list: {
    hasNextPage: boolean;
    isFetchingNextPage: boolean;
    fetchNextPage: () => Promise<unknown>;
  };
}

/** How many of how many are listed, and the way to the rest. */
export function ListFoot({ noun, shown, total, list }: Props) {
  return (
    <Group justify="space-between">
      <Text size="xs" className="quiet numbers" aria-live="polite" data-testid={`${noun}-count`}>
        {total !== undefined && `${shown} of ${count(total, noun)}`}
      </Text>
      {list.hasNextPage && (
        <Button
          variant="default"
          loading={list.isFetchingNextPage}
          onClick={() => void list.fetchNextPage()}
        >
          Load more
        </Button>
      )}
    </Group>
  );
}
