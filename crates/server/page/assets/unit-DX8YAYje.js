const t=["mm","um","deg","rpm","s","percent","n","nm"];function s(n){const e=n.slice(n.lastIndexOf("_")+1).toLowerCase();return t.includes(e)?e:""}export{s as u};
