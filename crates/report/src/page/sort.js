for(const b of document.querySelectorAll("th button"))b.onclick=()=>{const h=b.parentNode,t=h.closest("table"),i=h.cellIndex,up=h.getAttribute("aria-sort")=="descending";
for(const o of t.querySelectorAll("th"))o.removeAttribute("aria-sort");h.setAttribute("aria-sort",up?"ascending":"descending");
const v=r=>r.cells[i].textContent,n=r=>{const x=parseFloat(v(r).replace("−","-"));return isNaN(x)?-Infinity:x},w=h.classList.contains("l"),s=up?1:-1;
t.tBodies[0].append(...[...t.tBodies[0].rows].sort((a,b)=>s*(w?v(a).localeCompare(v(b)):n(a)-n(b))))};
