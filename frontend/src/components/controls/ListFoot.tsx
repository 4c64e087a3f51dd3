import { Button, Group, Text } from "@mantine/core";

interface Props {
  /** Counts of the list; empty until they are known. */
  counts: string;
  testId: string;
  list: {
    hasNextPage: boolean;
    isFetchingNextPage: boolean;
    fetchNextPage: () => Promise<unknown>;
  };
}

/** How many of how many are listed, and the way to the rest. */
export function ListFoot({ counts, testId, list }: Props) {
  return (
    <Group justify="space-between">
      <Text size="xs" className="quiet numbers" aria-live="polite" data-testid={testId}>
        {counts}
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
