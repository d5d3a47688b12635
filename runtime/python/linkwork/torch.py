"""Functions of mechanisms as operations of PyTorch, with exact gradients.

>>> import linkwork, linkwork.torch
>>> Arm = linkwork.compile("robot.urdf")
>>> arm = linkwork.torch.Operations(Arm)
>>> tau = arm.inverse_dynamics(q, v, a)     # tensors with any leading dimensions
>>> tau.sum().backward()

Gradients are vector–Jacobian products that are derived from the functions, not differences. Parameters may be tensors,
too: ``Operations(Pendulum, mass=mass, length=1.5)``. Computations are in double precision on the processor; results
have the type and device of the tensors.
"""

from typing import Any

import torch

from ._gradients import BaseOperations, Rollout, parameter_values
from ._mechanism import Mechanism


def _numpy(tensor: torch.Tensor) -> Any:
    return tensor.detach().to("cpu", torch.float64).numpy()


def _like(array: Any, tensor: torch.Tensor) -> torch.Tensor:
    return torch.from_numpy(array).to(tensor.device, tensor.dtype)


class _Call(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, operation: Any, *given: torch.Tensor) -> Any:
        ctx.operation = operation
        arrays = [_numpy(tensor) for tensor in given]
        found = [_like(array, given[-1]) for array in operation.evaluate(arrays)]
        ctx.save_for_backward(*given, *(found if isinstance(operation, Rollout) else []))
        return found[0] if len(found) == 1 else tuple(found)

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, *factors: torch.Tensor) -> Any:
        saved, operation = ctx.saved_tensors, ctx.operation
        arrays, own = [_numpy(tensor) for tensor in saved], [_numpy(tensor) for tensor in factors]
        if isinstance(operation, Rollout):
            given, found = saved[:4], operation.pull_back(arrays[:4], arrays[4:], own)
        else:
            given, found = saved, operation.pull_back(arrays, own)
        return None, *[_like(array, tensor) for array, tensor in zip(found, given)]


class Operations(BaseOperations):
    """The functions of a class as operations, with values of its parameters: numbers or tensors."""

    def __init__(self, kind: type[Mechanism], **parameters: Any) -> None:
        super().__init__(kind)
        values = [torch.as_tensor(value, dtype=torch.float64) for value in parameter_values(kind, parameters)]
        self.parameters = torch.stack(torch.broadcast_tensors(*values), dim=-1) if values else torch.zeros(0, dtype=torch.float64)

    def _apply(self, operation: Any, given: Any) -> Any:
        tensors = [value if isinstance(value, torch.Tensor) else torch.as_tensor(value, dtype=torch.float64) for value in given]
        return _Call.apply(operation, self.parameters, *tensors)
