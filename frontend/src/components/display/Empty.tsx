import { Stack, Text } from "@mantine/core";
import type { ReactNode } from "react";

/** Empty state with a title and the next step. */
export function Empty({ title, children }: { title: string; children?: ReactNode }) {
  return (
    <Stack align="center" gap={6} py={48} px="md" data-testid="empty">
      <Text fw={600}>{title}</Text>
      {children !== undefined && (
        <Text size="sm" className="quiet" component="div" ta="center" maw={520}>
          {children}
        </Text>
      )}
    </Stack>
  );
}
